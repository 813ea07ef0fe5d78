//! The thread of the fuzzer as the only one: no input is then read in another order than before, and none waits.

/// Makes all parallel work that of this thread.
pub fn alone() {
    rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .use_current_thread()
        .build_global()
        .expect("the first pool");
}
