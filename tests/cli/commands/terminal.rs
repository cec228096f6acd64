//! Tables and sentences in the width of a terminal.

use std::fs::File;
use std::io::Read;
use std::os::fd::{AsFd, OwnedFd};

use rustix::fs::{Mode, OFlags, open};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{Winsize, tcsetwinsize};

use super::*;

/// What a command prints on a terminal of so many columns, with the styles of the terminal.
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
    // The end of a terminal whose other side is closed is an error on Linux, the end of a file elsewhere.
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

/// A text without the styles of a terminal.
fn plain(text: &str) -> String {
    let mut parts = text.split("\u{1b}[");
    let first = parts.next().unwrap_or_default().to_owned();
    let rest = parts.map(|part| part.split_once('m').map_or(part, |(_, after)| after));
    first + &rest.collect::<String>()
}

/// Property: no line is wider than the terminal, whose width is kept within 60 to 140 columns; a pipe has 100.
#[test]
fn lines_fit_the_terminal() {
    let commands = [
        "run --ambient -10",
        "run --cycle ftp75 --price never",
        "study ambient --ambient -10,25 --start soak",
        "validate --chapter 3",
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
        "attribute --cycle ece15",
        "levers --samples 2 --cycle ece15",
        "explain transmission.cvt.belt",
        "check rover_216_cvt",
        "check --physics rover_216_cvt",
    ];
    let mut found = Vec::new();
    for command in commands {
        let words: Vec<&str> = command.split(' ').collect();
        for (columns, widest) in [(40, 60), (80, 80), (120, 120)] {
            // Once is enough for what takes its time; the five columns of `show` have no room in 60.
            if columns != 80 && ["validate", "levers", "rig", "study", "show"].contains(&words[0]) {
                continue;
            }
            let text = plain(&on_terminal(columns, &words));
            let wide = text.lines().filter(|line| line.chars().count() > widest);
            found.extend(wide.map(|line| format!("{command} at {columns}: {line}")));
        }
        let piped = stdout(&run(&words));
        let wide = piped.lines().filter(|line| line.chars().count() > 100);
        found.extend(wide.map(|line| format!("{command} in a pipe: {line}")));
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// The answer comes first, bold; verdicts have their colour on a terminal and none in a pipe.
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
