//! Hit or miss, distance, point and normal of every shape, against oracles of 640 bits that share no code with the
//! library.
//!
//! Each family of rays gets harder in steps. A ray is scored if its answer would survive a change of every input by 16
//! units of roundoff. Of those scored, none may be answered wrongly; the error of a distance is counted in the
//! change that a last place of every input explains (K), whose 99th percentile may be 4 and whose maximum 16. A
//! failing ray prints as a test.
//!
//! `WHITTED_RAYS=n` multiplies the numbers of rays. The longer run, of 1e8 rays scored one by one against the oracles and
//! more than twice as many against answers by construction, with the table of families, is
//!
//! ```text
//! WHITTED_RAYS=250 cargo test --release --test integration numerics -- --nocapture
//! ```

mod big;
mod cone;
mod cylinder;
mod everywhere;
mod flat;
mod fuzz;
mod gaps;
mod leaving;
mod meshes;
mod mirrors;
mod oracle;
mod random;
mod refraction;
mod round;
mod score;
mod sphere;
mod subject;
mod surface;
