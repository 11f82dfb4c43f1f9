//! The tests of the core, in one binary.

mod boards;
mod channels;
mod constants;
#[cfg(feature = "scene-file")]
mod drawn;
mod drawn_shapes;
mod even;
mod field;
#[cfg(feature = "scene-file")]
mod files;
#[cfg(feature = "scene-file")]
mod files_refused;
#[cfg(feature = "scene-file")]
mod golden;
mod greedy;
mod greedy_start;
mod laws;
mod layers;
mod map;
mod metrics;
mod motion;
#[cfg(feature = "scene-file")]
mod motion_files;
mod motions;
mod optimum;
#[allow(dead_code, unreachable_pub, reason = "an independent reference, also for tests to come")]
mod oracle;
mod order;
mod paper;
mod plausibility;
mod propagation;
mod props;
mod quantization;
mod range;
mod registry;
mod scene;
mod scenes;
mod session;
mod skin;
mod traps;
mod unsafe_code;
mod upper_bound;
