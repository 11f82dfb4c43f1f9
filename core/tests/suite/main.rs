//! The tests of the core, in one binary.

mod batch;
mod bound;
mod constants;
mod even;
mod field;
#[cfg(feature = "scene-file")]
mod files;
mod floors;
#[cfg(feature = "scene-file")]
mod golden;
mod greedy;
mod laws;
mod levels;
mod map;
mod metrics;
mod motions;
#[allow(dead_code, unreachable_pub, reason = "an independent reference, also for tests to come")]
mod oracle;
mod paper;
mod props;
mod registry;
mod rows;
mod scenes;
