//! Tests of `fast`.

use super::*;

#[test]
fn every_transducer_has_its_turn() {
    for count in 1..=300 {
        let mut order: Vec<usize> = stride(count, count as u64).collect();
        order.sort_unstable();
        assert!(order.into_iter().eq(0..count), "{count}");
    }
}
