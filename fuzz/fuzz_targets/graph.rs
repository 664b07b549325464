#![no_main]

use fieldtrace_fuzz::{abort_on_own_panics, graph};
use libfuzzer_sys::fuzz_target;

fuzz_target!(init: abort_on_own_panics(), |data: &[u8]| graph(data));
