//! What the program says of itself: help, completion scripts, manual pages.
#![cfg(feature = "cli")]

use std::fs;
use std::process::{Command, Output, Stdio};

const COMMANDS: [&str; 9] =
    ["render", "study", "compare", "inspect", "merge", "scenes", "view", "completions", "man"];

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_whitted")).args(arguments).output().expect("the program runs")
}

/// Standard output of a run that ends well.
#[track_caller]
fn said(arguments: &[&str]) -> String {
    let output = run(arguments);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// The words of a help text that look like flags.
fn flags(help: &str) -> Vec<String> {
    let is_part = |c: char| c.is_ascii_lowercase() || c == '-';
    let lines = help.lines().map(str::trim_start).filter(|line| line.starts_with('-'));
    let long = lines.filter_map(|line| line.find("--").map(|at| &line[at..]));
    let mut flags: Vec<String> =
        long.map(|rest| rest.chars().take_while(|c| is_part(*c)).collect()).collect();
    flags.dedup();
    flags
}

/// Runs what a shell makes of `script`; none if that shell is not there.
fn shell(name: &str, arguments: &[&str], script: &str) -> Option<Output> {
    let mut command = Command::new(name);
    command.args(arguments).arg(script).stdin(Stdio::null());
    command.output().ok()
}

#[test]
fn the_first_screen_shows_what_people_start_with_and_every_command() {
    let help = said(&["--help"]);
    let screen: Vec<&str> = help.lines().take(24).collect();
    for command in ["render", "view", "scenes", "inspect", "study"] {
        let example = format!("  whitted {command}");
        assert!(screen.iter().any(|line| line.starts_with(&example)), "{command}: {help}");
    }
    for command in COMMANDS {
        assert!(
            screen.iter().any(|line| line.starts_with(&format!("  {command} "))),
            "{command}: {help}"
        );
    }
}

#[test]
fn every_command_tells_its_flags_and_examples() {
    for command in COMMANDS {
        let help = said(&[command, "--help"]);
        assert!(help.contains("Examples:\n  whitted "), "{command}");
        assert!(flags(&help).contains(&"--help".to_owned()), "{command}");
        for line in help.lines() {
            assert!(line.chars().count() <= 125, "{command}: {line}");
        }
    }
    assert!(flags(&said(&["render", "--help"])).len() > 20);
}

/// Oracle: the help texts, and the shells themselves.
#[test]
fn scripts_complete_every_command_and_flag() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = said(&["completions", name]);
        for command in COMMANDS {
            assert!(script.contains(command), "{name}: {command}");
        }
        for flag in flags(&said(&["render", "--help"])) {
            let word = if name == "fish" { &flag[2..] } else { &flag };
            assert!(script.contains(word), "{name}: {flag}");
        }
        let path = folder.path().join(name);
        fs::write(&path, script).expect("written");
        if ["bash", "zsh", "fish"].contains(&name)
            && let Some(output) = shell(name, &["-n"], path.to_str().expect("UTF-8"))
        {
            assert!(output.status.success(), "{name}: {output:?}");
        }
    }
    assert_eq!(run(&["completions", "cmd"]).status.code(), Some(2));
}

/// Oracle: bash completes a line as it would for a user.
#[cfg(unix)]
#[test]
fn bash_completes_words() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("whitted.bash");
    fs::write(&path, said(&["completions", "bash"])).expect("written");
    let complete = |line: &str| {
        let words: Vec<&str> = line.split(' ').collect();
        let script = format!(
            "source '{}'; COMP_WORDS=({}); COMP_CWORD={}; _whitted whitted '{}' '{}'; echo \"${{COMPREPLY[@]}}\"",
            path.display(),
            words.iter().map(|word| format!("'{word}'")).collect::<Vec<_>>().join(" "),
            words.len() - 1,
            words[words.len() - 1],
            words[words.len() - 2],
        );
        let output = shell("bash", &["--norc", "-c"], &script)?;
        Some(String::from_utf8(output.stdout).expect("UTF-8").trim().to_owned())
    };
    let Some(commands) = complete("whitted comp") else { return };
    assert_eq!(commands, "compare completions");
    assert_eq!(complete("whitted render --max").as_deref(), Some("--max-error"));
    assert_eq!(complete("whitted render --progress op").as_deref(), Some("openjd"));
}

/// Oracle: mandoc and groff read the pages without a warning, where they are.
#[test]
fn manual_pages_hold_every_command_and_flag() {
    let main = said(&["man"]);
    let unescaped = |page: &str| page.replace("\\-", "-");
    for command in COMMANDS {
        assert!(unescaped(&main).contains(command), "{command}");
        let page = said(&["man", command]);
        assert!(page.contains(".SH NAME") && page.contains(".SH SYNOPSIS"), "{command}");
        for flag in flags(&said(&[command, "--help"])) {
            assert!(unescaped(&page).contains(&flag), "{command}: {flag}");
        }
    }
    let folder = tempfile::tempdir().expect("a folder");
    let pages = folder.path().join("share/man/man1");
    said(&["man", "--folder", pages.to_str().expect("UTF-8")]);
    let names = fs::read_dir(&pages).expect("made").map(|entry| entry.expect("an entry").path());
    let names: Vec<_> = names.collect();
    assert_eq!(names.len(), 1 + COMMANDS.len(), "{names:?}");
    for page in names {
        if let Ok(output) =
            Command::new("groff").args(["-man", "-Tutf8", "-ww"]).arg(&page).output()
        {
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success() && said.is_empty(), "{}: {said}", page.display());
        }
    }
    let wrong = run(&["man", "rendr"]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&wrong.stderr).contains("choose one of render, "));
}
