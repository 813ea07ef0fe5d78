//! What the readers of text formats share: bytes to text, text to lines, lines to tokens and numbers.
//!
//! Real files come in any encoding and with any line ends. Everything here works on bytes, keeps the line number, and
//! takes no memory in proportion to what a file merely claims.

pub mod decode;
pub mod lines;
pub mod number;
pub mod tokens;

pub use decode::{TextError, decode, name_of, read_limited, read_stdin};
pub use lines::{Lines, line_ends};
pub use number::{float, integer};
pub use tokens::Tokens;
