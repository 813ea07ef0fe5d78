//! What the program says of itself: help, completion scripts, manual pages.
#![cfg(feature = "cli")]

#[path = "program/mod.rs"]
mod program;

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use program::{done, folder, said, text};

const COMMANDS: [&str; 9] =
    ["render", "study", "compare", "inspect", "merge", "scenes", "view", "completions", "man"];

fn run(arguments: &[&str]) -> Output {
    program::run(Path::new("."), arguments)
}

/// Standard output of a run that ends well.
#[track_caller]
fn told(arguments: &[&str]) -> String {
    let output = run(arguments);
    done(&output);
    text(&output.stdout).to_owned()
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
    let help = told(&["--help"]);
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
        let help = told(&[command, "--help"]);
        assert!(help.contains("Examples:\n  whitted "), "{command}");
        assert!(flags(&help).contains(&"--help".to_owned()), "{command}");
        for line in help.lines() {
            assert!(line.chars().count() <= 125, "{command}: {line}");
        }
    }
    assert!(flags(&told(&["render", "--help"])).len() > 20);
}

/// Oracle: the help texts, and the shells themselves.
#[test]
fn scripts_complete_every_command_and_flag() {
    let folder = folder();
    for name in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = told(&["completions", name]);
        for command in COMMANDS {
            assert!(script.contains(command), "{name}: {command}");
        }
        for flag in flags(&told(&["render", "--help"])) {
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
    let folder = folder();
    let path = folder.path().join("whitted.bash");
    fs::write(&path, told(&["completions", "bash"])).expect("written");
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
    let main = told(&["man"]);
    let unescaped = |page: &str| page.replace("\\-", "-");
    for command in COMMANDS {
        assert!(unescaped(&main).contains(command), "{command}");
        let page = told(&["man", command]);
        assert!(page.contains(".SH NAME") && page.contains(".SH SYNOPSIS"), "{command}");
        for flag in flags(&told(&[command, "--help"])) {
            assert!(unescaped(&page).contains(&flag), "{command}: {flag}");
        }
    }
    let folder = folder();
    let pages = folder.path().join("share/man/man1");
    told(&["man", "--folder", pages.to_str().expect("UTF-8")]);
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
    assert!(said(&wrong).contains("choose one of render, "));
}
