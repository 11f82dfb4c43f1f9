//! Answer: results of a solve besides the drive: status, steps, scale, metrics.

/// How a solve ended.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub enum Status {
    /// The method ran to its end.
    Done = 0,
    /// The method's steps ran out before its tolerance was met.
    OutOfSteps = 1,
    /// The solve was stopped; the answer is the best result so far.
    Stopped = 2,
    /// The method ran to its end, and the targets are missed by more than 1 %.
    Missed = 3,
}

/// How good a drive is, over the points with a pressure and a weight above 0, x_j = |p_j| / target_j.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Metrics {
    /// sum |p_j| / sum target_j, unclipped: eq. (12).
    pub accuracy: f64,
    /// Standard deviation (1/M) of x / max x: eq. (13) for equal targets. 0 for one point or silence.
    pub sigma: f64,
    /// min x / max x; 1 for one point, 0 in silence.
    pub uniformity: f64,
    /// Mean x.
    pub level: f64,
    /// sum w (target - |p|)^2 / sum w target^2: eq. (7) relative to silence.
    pub residual: f64,
    /// max |p_j| over the quiet points (target 0) over the largest target; 0 where there are none.
    pub leak: f64,
}

/// Results of a solve besides the drive.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Answer {
    /// How the solve ended.
    pub status: Status,
    /// The number of steps taken.
    pub steps: usize,
    /// The factor that supply voltage or modulation must apply to the drive; 1 unless the board's amplitudes are too coarse.
    pub scale: f64,
    /// Metrics of the drive, with the scale applied.
    pub metrics: Metrics,
}

impl From<midair::Metrics> for Metrics {
    fn from(metrics: midair::Metrics) -> Self {
        let midair::Metrics { accuracy, sigma, uniformity, level, residual, leak } = metrics;
        Self { accuracy, sigma, uniformity, level, residual, leak }
    }
}

impl From<midair::Status> for Status {
    fn from(status: midair::Status) -> Self {
        [Self::Done, Self::OutOfSteps, Self::Stopped, Self::Missed][status as usize]
    }
}

impl From<&midair::Solution> for Answer {
    fn from(solution: &midair::Solution) -> Self {
        let midair::Solution { status, steps, scale, .. } = *solution;
        Self { status: status.into(), steps, scale, metrics: solution.metrics().into() }
    }
}
