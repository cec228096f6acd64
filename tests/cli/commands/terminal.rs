//! Wrapping of tables and sentences to the width of the terminal.

use std::collections::HashSet;
use std::fs::File;
use std::io::Read;
use std::os::fd::{AsFd, OwnedFd};

use rustix::fs::{Mode, OFlags, open};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{Winsize, tcsetwinsize};

use super::*;

/// Output of a command on a terminal with a number of columns, including escape codes.
fn on_terminal(columns: u16, words: &[&str]) -> String {
    let ours = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    grantpt(&ours).unwrap();
    unlockpt(&ours).unwrap();
    let name = ptsname(&ours, Vec::new()).unwrap();
    let theirs = open(&name, OFlags::RDWR | OFlags::NOCTTY, Mode::empty()).unwrap();
    resize(&theirs, columns);
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin!("cvtcycle"))
        .args(words)
        .env_remove("NO_COLOR")
        .env("TERM", "xterm")
        .stdin(Stdio::null())
        .stdout(theirs)
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut bytes = Vec::new();
    // Reading from a terminal whose other side is closed is an error on Linux, and the end of the file elsewhere.
    drop(File::from(ours).read_to_end(&mut bytes));
    assert_eq!(child.wait().unwrap().code(), Some(0), "{words:?}");
    String::from_utf8(bytes).unwrap().replace('\r', "")
}

fn resize(terminal: &OwnedFd, columns: u16) {
    let size = Winsize {
        ws_row: 40,
        ws_col: columns,
        ws_xpixel: 0,
        ws_ypixel: 0,
    };
    tcsetwinsize(terminal.as_fd(), size).unwrap();
}

/// Removes escape codes.
fn plain(text: &str) -> String {
    let mut parts = text.split("\u{1b}[");
    let first = parts.next().unwrap_or_default().to_owned();
    let rest = parts.map(|part| part.split_once('m').map_or(part, |(_, after)| after));
    first + &rest.collect::<String>()
}

/// Characters after which a long word may be broken.
const JOINTS: [char; 5] = ['/', '_', ':', '.', ','];

/// Words of a text, or parts of words between joints, that the wider text does not contain.
fn cut_words(text: &str, wider: &str) -> Vec<String> {
    let parts = |text: &str| -> HashSet<String> {
        let words = text.split_whitespace();
        let parts = words.flat_map(|word| word.split_inclusive(JOINTS));
        parts.map(str::to_owned).collect()
    };
    parts(text).difference(&parts(wider)).cloned().collect()
}

/// Property: no line exceeds the width of the terminal, clamped to 60 to 140 columns, and no word is cut. A pipe has 100 columns.
#[test]
fn lines_fit_the_terminal() {
    let commands = [
        "run --ambient -10",
        "run --cycle ftp75 --price never",
        "study ambient --ambient -10,25 --start soak",
        "study pump_and_offset",
        "study uncertainty_rover --samples 8",
        "validate --chapter 3",
        "validate",
        "list cycles",
        "list vehicles",
        "list classes",
        "list lubricants",
        "list levers",
        "list plans",
        "show rover_216_cvt",
        "show civic_20_cvt",
        "show wltc_class3b",
        "rig transmission",
        "rig variator",
        "losses",
        "losses --speed 1000..3000:1000 --torque 0,50",
        "calibrate rover_216_warm_up --no-folds",
        "optimum --cycle ece15",
        "label civic_20_cvt civic_20_6mt",
        "attribute --cycle ece15",
        "levers --samples 2 --cycle ece15",
        "explain transmission.cvt.belt",
        "check rover_216_cvt",
        "check --physics rover_216_cvt",
    ];
    let mut found = Vec::new();
    for command in commands {
        let words: Vec<&str> = command.split(' ').collect();
        let widest = plain(&on_terminal(200, &words));
        for (columns, most) in [(40, 60), (80, 80), (120, 120), (200, 140)] {
            // The narrowest and the widest text suffice for slow commands.
            let slow = ["validate", "levers", "study", "calibrate", "optimum"];
            if (columns == 80 || columns == 120) && slow.contains(&words[0]) {
                continue;
            }
            let text = match columns {
                200 => widest.clone(),
                _ => plain(&on_terminal(columns, &words)),
            };
            let wide = text.lines().filter(|line| line.chars().count() > most);
            found.extend(wide.map(|line| format!("{command} at {columns}: {line}")));
            let cut = cut_words(&text, &widest);
            found.extend(
                cut.iter()
                    .map(|word| format!("{command} at {columns}: {word} is cut")),
            );
        }
        let piped = stdout(&run(&words));
        let wide = piped.lines().filter(|line| line.chars().count() > 100);
        found.extend(wide.map(|line| format!("{command} in a pipe: {line}")));
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// The answer comes first, in bold. Verdicts are coloured on a terminal and plain in a pipe.
#[test]
fn the_answer_is_first_and_verdicts_have_colours() {
    let text = on_terminal(80, &["run", "--ambient", "-10"]);
    assert!(
        text.starts_with("\u{1b}[1mrover_216_cvt: 8.24 L/100 km"),
        "{text}"
    );
    let text = on_terminal(100, &["validate", "--chapter", "1"]);
    assert!(text.contains("\u{1b}[1;31mdiffers\u{1b}[0m"), "{text}");
    assert!(text.contains("\u{1b}[32magrees\u{1b}[0m"), "{text}");
    let piped = stdout(&run(&["validate", "--chapter", "1"]));
    assert!(!piped.contains('\u{1b}') && piped.contains("differs"));
}
