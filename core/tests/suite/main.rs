//! The tests of the core, in one binary.

mod greedy;
#[allow(dead_code, unreachable_pub, reason = "an independent reference, also for tests to come")]
mod oracle;
mod scenes;
