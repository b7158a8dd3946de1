//! Seconds of the processor: what else the machine does is left out of them.

/// Gives the seconds that this thread has been computing.
#[cfg(unix)]
pub(super) fn processor() -> impl Fn() -> f64 {
    use rustix::time::{ClockId, clock_gettime};
    || {
        let now = clock_gettime(ClockId::ThreadCPUTime);
        now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64
    }
}

/// Gives the seconds that went by: there is no clock of the thread here.
#[cfg(not(unix))]
pub(super) fn processor() -> impl Fn() -> f64 {
    let start = std::time::Instant::now();
    move || start.elapsed().as_secs_f64()
}

#[cfg(test)]
mod tests {
    #[test]
    fn computing_takes_time() {
        let now = super::processor();
        let start = now();
        let mut seed = 1_u64;
        while now() - start < 1e-3 {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        }
        assert_ne!(seed, 1);
    }
}
