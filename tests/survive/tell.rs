//! What a render tells while it goes on, and in what colours.

use super::{done, folder, refused, run, said, whitted};

const SMALL: [&str; 6] = ["render", "--size", "64x48", "--aa", "grid:3", "--progress"];

#[test]
fn openjd_lines_end_with_all_of_it() {
    let folder = folder();
    let output = run(folder.path(), &[&SMALL[..], &["openjd"]].concat());
    done(&output);
    let told = said(&output);
    let lines: Vec<&str> = told.lines().filter(|line| line.starts_with("openjd_")).collect();
    assert!(lines.contains(&"openjd_progress: 100.0"), "{told}");
    assert!(lines.last().is_some_and(|line| line.starts_with("openjd_status: ")), "{told}");
}

#[test]
fn json_lines_have_a_rate_and_a_time() {
    let folder = folder();
    let output = run(folder.path(), &[&SMALL[..], &["json"]].concat());
    done(&output);
    let told = said(&output);
    let last = super::json(told.lines().last().expect("a line").as_bytes());
    assert!(last["pixels_per_second"].as_f64().expect("a number") > 0.0);
    assert_eq!(last["seconds_left"], 0.0);
}

/// Source: no-color.org and bixense.com/clicolors; standard error is a pipe here.
#[test]
fn words_are_coloured_only_where_that_is_wanted() {
    let folder = folder();
    let cases: &[(&[(&str, &str)], bool)] = &[
        (&[], false),
        (&[("CLICOLOR_FORCE", "1")], true),
        (&[("CLICOLOR_FORCE", "0")], false),
        (&[("CLICOLOR_FORCE", "1"), ("NO_COLOR", "1")], false),
        (&[("CLICOLOR_FORCE", "1"), ("NO_COLOR", "")], true),
        (&[("CLICOLOR_FORCE", "1"), ("TERM", "dumb")], true),
    ];
    for (variables, is_colored) in cases {
        let mut command = whitted(folder.path(), &["render", "nowhere"]);
        for name in ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE", "TERM"] {
            command.env_remove(name);
        }
        let output = command.envs(variables.iter().copied()).output().expect("it runs");
        refused(&output, 2, &["nowhere"]);
        assert_eq!(said(&output).contains('\x1b'), *is_colored, "{variables:?}");
    }
}

/// `script` gives the program a terminal. Without one of that name the test has nothing to show.
#[cfg(target_os = "linux")]
#[test]
fn a_terminal_gets_a_bar_and_a_dumb_one_gets_lines() {
    use std::process::{Command, Stdio};
    let folder = folder();
    let program = env!("CARGO_BIN_EXE_whitted");
    let line = format!("{program} render --size 300x200 --aa grid:6");
    let on_terminal = |term: &str| {
        Command::new("script")
            .args(["-qec", &line, "/dev/null"])
            .env("TERM", term)
            .env("NO_COLOR", "1")
            .current_dir(folder.path())
            .stdin(Stdio::null())
            .output()
    };
    let Ok(bar) = on_terminal("xterm") else { return };
    let (bar, dumb) = (bar.stdout, on_terminal("dumb").expect("it ran before").stdout);
    let (bar, dumb) = (String::from_utf8_lossy(&bar), String::from_utf8_lossy(&dumb));
    assert!(bar.contains("pixels/s") && bar.contains(" left"), "{bar:?}");
    assert!(dumb.contains("wrote assignment.png") && !dumb.contains('\x1b'), "{dumb:?}");
}

/// Oracle: the same render without a preview. `script` (util-linux) gives it a terminal of 80 x 24, where it is installed.
#[cfg(target_os = "linux")]
#[test]
fn a_preview_is_drawn_on_a_terminal_and_changes_nothing() {
    let folder = folder();
    let preview = [&SMALL[..], &["plain", "--preview", "-o", "a.png"]].concat();
    let output = run(folder.path(), &preview);
    done(&output);
    assert!(said(&output).contains("warning: --preview: ") && !said(&output).contains('▀'));
    let bytes = |name: &str| std::fs::read(folder.path().join(name)).expect(name);
    done(&run(folder.path(), &[&SMALL[..], &["none", "-o", "b.png"]].concat()));
    assert!(bytes("a.png") == bytes("b.png"));

    let program = env!("CARGO_BIN_EXE_whitted");
    let command = format!("{program} {}", preview.join(" ").replace("a.png", "c.png"));
    let mut script = std::process::Command::new("script");
    script.current_dir(folder.path()).env("TERM", "xterm").args(["-qec", &command, "/dev/null"]);
    let Ok(output) = script.stdin(std::process::Stdio::null()).output() else { return };
    let told = String::from_utf8_lossy(&output.stdout);
    let drawn = told.lines().filter(|line| line.matches('▀').count() == 59).count();
    assert!(drawn >= 22 && drawn % 22 == 0 && told.contains("100 %"), "{drawn}: {told}");
    assert!(bytes("c.png") == bytes("b.png"));
}
