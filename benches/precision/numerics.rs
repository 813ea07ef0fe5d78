//! The oracle of the tests, which shares no code with the library nor with the forms compared here.
#![allow(dead_code, reason = "the tests use more of it")]

#[path = "../../tests/integration/numerics/big.rs"]
pub(crate) mod big;
#[path = "../../tests/integration/numerics/oracle.rs"]
pub(crate) mod oracle;
#[path = "../../tests/integration/numerics/random.rs"]
pub(crate) mod random;
#[path = "../../tests/integration/numerics/round.rs"]
pub(crate) mod round;
#[path = "../../tests/integration/numerics/subject.rs"]
pub(crate) mod subject;
