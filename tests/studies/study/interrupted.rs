//! Interrupted and resumed studies, and full disks. Truth: the same study without interruption.

use super::*;

/// Waits for a number of parts, or the end of the process.
fn wait_for_parts(child: &mut Child, dir: &Path, count: usize) {
    while parts(dir) < count && child.try_wait().unwrap().is_none() {
        sleep(Duration::from_millis(1));
    }
}

/// Property behind resuming: killed repeatedly at moments that sweep over the writing of a part, a study ends with
/// the bytes of an undisturbed one. One thread gives the bytes of three.
#[test]
fn killed_at_many_moments_it_ends_with_the_same_bytes() {
    let dir = folder(&PLAN);
    ends(
        dir.path(),
        &[
            "study",
            "plan.toml",
            "--out",
            "whole",
            "--quiet",
            "--threads",
            "1",
        ],
        0,
    );
    let mut kills = 0_usize;
    let mut first = true;
    loop {
        let mut words = vec![
            "study",
            "plan.toml",
            "--out",
            "killed",
            "--quiet",
            "--threads",
            "3",
        ];
        words.extend((!first).then_some("--resume"));
        let before = parts(&dir.path().join("killed"));
        let mut child = program(dir.path(), &words)
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        wait_for_parts(&mut child, &dir.path().join("killed"), before + 1);
        // Steps of a third of a millisecond: within the writing of a part, between parts, during computing.
        sleep(Duration::from_micros(333 * (kills as u64 % 40)));
        child.kill().unwrap();
        let status = child.wait().unwrap();
        // A study killed before its manifest was written has to start again.
        first = !dir.path().join("killed/study.json").exists();
        if status.code() == Some(0) {
            break;
        }
        assert_eq!(status.code(), None, "it was killed");
        kills += 1;
        let now = parts(&dir.path().join("killed"));
        assert!(now >= before, "a whole part was lost");
        assert!(kills < 500);
    }
    assert!(kills >= 10, "only {kills} kills");
    same(&dir.path().join("whole"), &dir.path().join("killed"));
    // Finished parts are kept.
    ends(
        dir.path(),
        &[
            "study",
            "plan.toml",
            "--out",
            "killed",
            "--quiet",
            "--resume",
        ],
        0,
    );
    same(&dir.path().join("whole"), &dir.path().join("killed"));
}

/// Ctrl-C: code 130, complete parts kept, no partial file, and the rest can be computed later.
#[test]
fn ctrl_c_stops_with_whole_parts() {
    let dir = folder(&PLAN);
    let out = dir.path().join("out");
    let mut child = program(dir.path(), &["study", "plan.toml", "--out", "out"])
        .stderr(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    wait_for_parts(&mut child, &out, 2);
    assert!(
        Command::new("kill")
            .args(["-INT", &child.id().to_string()])
            .status()
            .unwrap()
            .success()
    );
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    assert!(stderr(&output).contains("--resume"), "{}", stderr(&output));
    assert!(
        tree(&out)
            .keys()
            .all(|name| !name.to_string_lossy().contains(".tmp")),
        "something half written"
    );
    let shown = ends(dir.path(), &["study", "show", "out", "--json"], 0);
    let done = json(&shown)["points_done"].as_u64().unwrap();
    assert!(done > 0 && done < 5000, "{done}");
    ends(
        dir.path(),
        &["study", "plan.toml", "--out", "whole", "--quiet"],
        0,
    );
    ends(
        dir.path(),
        &["study", "plan.toml", "--out", "out", "--quiet", "--resume"],
        0,
    );
    same(&out, &dir.path().join("whole"));
}

/// A disk that is really full: a small tmpfs. Complete parts are kept, the message has advice, and with room the study ends with the
/// bytes of an undisturbed one.
#[test]
fn a_full_disk_loses_nothing() {
    let dir = folder(&PLAN);
    let bin = assert_cmd::cargo::cargo_bin("cvtcycle");
    let script = format!(
        "mkdir small && mount -t tmpfs -o size=640k none small || exit 77\n\
         '{0}' study plan.toml --out small/out --quiet 2>full.txt; echo $? >full.code\n\
         ls small/out/parts | grep -c sha256 >full.parts\n\
         ls -a small/out small/out/parts | grep -c tmp >full.tmp\n\
         mount -o remount,size=64m none small || exit 77\n\
         '{0}' study plan.toml --out small/out --quiet --resume; echo $? >again.code\n\
         cp -r small/out copy\n",
        bin.display()
    );
    let status = Command::new("unshare")
        .args(["-rm", "sh", "-c", &script])
        .current_dir(dir.path())
        .stderr(Stdio::null())
        .status();
    if !status.is_ok_and(|status| status.success()) {
        assert!(
            std::env::var_os("CVTCYCLE_REQUIRE_FULL_DISK").is_none(),
            "no small file system can be mounted here"
        );
        eprintln!("skipped: no small file system can be mounted here");
        return;
    }
    let text = |name: &str| fs::read_to_string(dir.path().join(name)).unwrap();
    assert_eq!(text("full.code").trim(), "2", "{}", text("full.txt"));
    assert!(
        text("full.txt").contains("No space left") && text("full.txt").contains("--resume"),
        "{}",
        text("full.txt")
    );
    let kept: usize = text("full.parts").trim().parse().unwrap();
    assert!(kept > 0 && kept < 32, "{kept}");
    assert_eq!(text("full.tmp").trim(), "0", "something half written");
    assert_eq!(text("again.code").trim(), "0");
    ends(
        dir.path(),
        &["study", "plan.toml", "--out", "whole", "--quiet"],
        0,
    );
    same(&dir.path().join("copy"), &dir.path().join("whole"));
}

/// Another plan, seed or car is not the study in the directory.
#[test]
fn resume_requires_the_same_study() {
    let small = PLAN.replace("samples = 5000", "samples = 40");
    let dir = folder(&small);
    ends(
        dir.path(),
        &["study", "plan.toml", "--out", "out", "--quiet"],
        0,
    );
    let message = stderr(&ends(
        dir.path(),
        &[
            "study",
            "plan.toml",
            "--out",
            "out",
            "--resume",
            "--seed",
            "8",
        ],
        2,
    ));
    assert!(message.contains("seed"), "{message}");
    let message = stderr(&ends(
        dir.path(),
        &["study", "plan.toml", "--out", "out"],
        2,
    ));
    assert!(
        message.contains("--resume") && message.contains("--force"),
        "{message}"
    );
    fs::write(
        dir.path().join("minute.csv"),
        CYCLE.replace("70,road", "71,road"),
    )
    .unwrap();
    let message = stderr(&ends(
        dir.path(),
        &["study", "plan.toml", "--out", "out", "--resume"],
        2,
    ));
    assert!(message.contains("cycles"), "{message}");
    let message = stderr(&ends(
        dir.path(),
        &["study", "plan.toml", "--out", "nothing", "--resume"],
        2,
    ));
    assert!(message.contains("there is no study"), "{message}");
    ends(
        dir.path(),
        &["study", "plan.toml", "--out", "out", "--force", "--quiet"],
        0,
    );
}
