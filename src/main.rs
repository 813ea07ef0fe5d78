//! The `whitted` command.

fn main() {}
