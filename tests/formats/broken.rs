//! Broken and odd files, each with what is said about it.
