//! Paths: points that move for a time, each with a target, as functions of time.

use crate::points::curve::Curve;
use crate::points::modulation::{Modulation, ROUNDING};
use crate::prelude::*;
use crate::scene::{distance, figures};

/// Largest coordinate in m; points farther away are rejected.
pub const FARTHEST: f64 = 1e6;

/// Largest number of frames, times points, in one call; 10^8 take 3.2 GB.
const MOST_FRAMES: f64 = 1e8;

/// M points that move for a time, with a target for each. It is cheap to copy.
///
/// Targets are in Pa (peak) if pressures were given. Otherwise they are factors: 1, times modulation and fades. A point whose
/// target is 0 is absent.
///
/// ```
/// use midair::points::{Curve, Path, Run};
///
/// let circle = Curve::circle([0.0, 0.0, 0.15], 0.02, [0.0, 0.0, 1.0], 0.0)?;
/// let ring = Path::along(circle, Run { frequency: Some(50.0), points: 2, ..Run::default() }, None)?;
/// let frames = ring.frames(1e3)?;
/// assert_eq!((frames.points.len(), frames.points[1]), (40, [-0.02, 2.4492935982947065e-18, 0.15]));
/// # Ok::<(), midair::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Path {
    pub(super) points: usize,
    pub(super) duration: f64,
    pub(super) closed: bool,
    pub(super) pascals: bool,
    /// The highest frequency of amplitude modulation in Hz.
    pub(super) modulation: f64,
    pub(super) course: Arc<Course>,
}

/// How the points of a path move.
#[derive(Debug)]
pub(super) enum Course {
    /// Evenly spaced points on one curve; each moves by `way` m.
    Curve { curve: Curve, way: f64, targets: Vec<f64> },
    /// Frames (K, M) at a rate, with straight lines between them; a closed path goes on from the last to the first.
    Frames { rate: f64, places: Vec<[f64; 3]>, targets: Vec<f64> },
    /// All paths at the same time; closed ones repeat.
    Beside(Vec<Path>),
    /// One path after the other, each with its start in s.
    Chain(Vec<Link>),
    /// Points at rest whose targets change along half a period of a cosine.
    Fade { places: Vec<[f64; 3]>, before: Vec<f64>, after: Vec<f64> },
    /// A path whose targets are multiplied by a modulation.
    Modulated(Path, Modulation),
}

/// A path in a chain of paths with M slots for points.
#[derive(Clone, Debug)]
pub(super) struct Link {
    pub(super) start: f64,
    pub(super) path: Path,
    /// For each slot, the number of its point in the path; `None` if it has no point.
    pub(super) slots: Vec<Option<usize>>,
    /// Places of the slots without a point, whose target is 0.
    pub(super) idle: Vec<[f64; 3]>,
}

/// A point of a path at a time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moment {
    /// Place in m.
    pub place: [f64; 3],
    /// Speed in m/s.
    pub speed: f64,
    /// Target in Pa, or a factor from 0 to 1.
    pub target: f64,
}

/// How points move along a curve.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// Speed in m/s; or `frequency`.
    pub speed: Option<f64>,
    /// Runs per second; or `speed`.
    pub frequency: Option<f64>,
    /// How often the curve is run through; a run of whole turns along a closed curve is closed.
    pub turns: f64,
    /// The number of points M, evenly spaced.
    pub points: usize,
}

impl Default for Run {
    fn default() -> Self {
        Self { speed: None, frequency: None, turns: 1.0, points: 1 }
    }
}

/// T frames of M points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PathFrames {
    /// Points (T, M) in m.
    pub points: Vec<[f64; 3]>,
    /// Targets (T, M) in Pa, or factors from 0 to 1.
    pub targets: Vec<f64>,
}

impl Path {
    /// Creates a path along a curve, with pressures for all points or for each in Pa.
    ///
    /// # Errors
    /// Neither or both of speed and frequency, a number that is not above 0, a curve of no length; wrong pressures.
    pub fn along(curve: Curve, run: Run, pressures: Option<&[f64]>) -> Result<Self> {
        let Run { speed, frequency, turns, points } = run;
        real("turns", turns, 0.0, true)?;
        if !(1..=super::MOST).contains(&points) {
            return Err(Error::out_of_range("points", points, format!("give 1 to {}", super::MOST)));
        }
        let (targets, way) = (spread(pressures, 1, points)?, turns * curve.length());
        let (duration, closed) = (lasting(way, turns, speed, frequency)?, curve.closed() && turns == math::rint(turns));
        Ok(Self::new(points, duration, closed, pressures, Course::Curve { curve, way, targets }))
    }

    /// Creates a path through frames of points (K, M) in m at a rate in frames per second, straight between them. Pressures in
    /// Pa are one number, (M,) or (K, M). If `closed`, the last frame goes on to the first.
    ///
    /// # Errors
    /// Fewer than two frames, a point that is not finite or too far away; a rate that is not above 0, wrong pressures.
    pub fn through(
        places: Vec<[f64; 3]>,
        points: usize,
        rate: f64,
        closed: bool,
        pressures: Option<&[f64]>,
    ) -> Result<Self> {
        Self::straight(places, points, frame_rate(rate)?, closed, pressures)
    }

    /// Creates the path of [`Path::through`]; a path that rests or lasts long may have any rate.
    fn straight(
        places: Vec<[f64; 3]>,
        points: usize,
        rate: f64,
        closed: bool,
        pressures: Option<&[f64]>,
    ) -> Result<Self> {
        let count = places.len() / points.max(1);
        if points == 0 || count < 2 || count * points != places.len() {
            let cure = "give at least two frames of as many points, at least one";
            return Err(Error::invalid("points", format!("{} in frames of {points}", places.len()), cure));
        }
        near(&places, |k| format!("point {} of frame {}", k % points, k / points))?;
        let duration = (count - usize::from(!closed)) as f64 / rate;
        if !duration.is_finite() {
            let cure = format!("the path would last {duration} s, give another");
            return Err(Error::out_of_range("rate", format_args!("{rate:?}"), cure));
        }
        let targets = spread(pressures, count, points)?;
        Ok(Self::new(points, duration, closed, pressures, Course::Frames { rate, places, targets }))
    }

    /// Creates a path of points at rest in m. It is closed: its duration in s is that of a period.
    ///
    /// # Errors
    /// No place, wrong places or pressures, a duration that is not above 0.
    pub fn still(places: &[[f64; 3]], duration: f64, pressures: Option<&[f64]>) -> Result<Self> {
        check_set("places", places)?;
        Self::straight([places, places].concat(), places.len(), rate_of(2.0, duration)?, true, pressures)
    }

    /// Creates a path from points (M,) to as many others in m, each straight and at constant speed. Either the duration in s or
    /// the speed in m/s of the point with the longest way is given.
    ///
    /// # Errors
    /// Other numbers of points, wrong points or pressures, neither or both of duration and speed.
    pub fn morph(
        from: &[[f64; 3]],
        to: &[[f64; 3]],
        duration: Option<f64>,
        speed: Option<f64>,
        pressures: Option<&[f64]>,
    ) -> Result<Self> {
        either(["duration", "speed"], [duration, speed], "give duration in s, or speed in m/s")?;
        check_set("from_points", from)?;
        check_set("to_points", to)?;
        if from.len() != to.len() {
            let cure = format!("give {} as from_points, or join paths with a fade, a.then(b, fade=)", from.len());
            return Err(Error::invalid("to_points", format!("{} points", to.len()), cure));
        }
        let longest = from.iter().zip(to).map(|(&from, &to)| distance(from, to)).fold(0.0, f64::max);
        let duration = duration.map_or_else(|| lasting(longest, 1.0, speed, None), Ok)?;
        Self::straight([from, to].concat(), from.len(), rate_of(1.0, duration)?, false, pressures)
    }

    fn new(points: usize, duration: f64, closed: bool, pressures: Option<&[f64]>, course: Course) -> Self {
        let course = Arc::new(course);
        Self { points, duration, closed, pascals: pressures.is_some(), modulation: 0.0, course }
    }

    /// Returns the path with its amplitude modulated.
    ///
    /// # Errors
    /// A closed path without a whole number of periods.
    pub fn modulated(&self, by: Modulation) -> Result<Self> {
        let periods = by.frequency() * self.duration;
        if self.closed && (periods - math::rint(periods)).abs() > ROUNDING * periods.max(1.0) {
            let near = [math::floor(periods), math::ceil(periods)].into_iter().filter(|&periods| periods > 0.0);
            let near: Vec<_> = near.map(|periods| figures(periods / self.duration, 10)).collect();
            let lasts = format!("the closed path of {} s would hold", figures(self.duration, 6));
            let jump = format!("{} periods and jump at its seam, give {} Hz", figures(periods, 6), near.join(" or "));
            return Err(Error::invalid("frequency", format_args!("{:?}", by.frequency()), format!("{lasts} {jump}")));
        }
        let modulation = self.modulation.max(by.finest());
        Ok(Self { modulation, course: Arc::new(Course::Modulated(self.clone(), by)), ..self.clone() })
    }

    /// Returns a point at a time in s. A closed path repeats, an open one rests before and after; at a corner the speed is
    /// that after it.
    pub fn at(&self, time: f64, point: usize) -> Moment {
        let rest = time % self.duration;
        let time = match self.closed {
            true if rest < 0.0 => rest + self.duration,
            true => rest,
            false => time.clamp(0.0, self.duration),
        };
        match &*self.course {
            Course::Curve { curve, way, targets } => {
                let start = curve.length() * point as f64 / self.points as f64;
                let place = curve.after(start + way * (time / self.duration));
                Moment { place, speed: way / self.duration, target: targets[point] }
            }
            Course::Frames { rate, places, targets } => {
                let count = places.len() / self.points;
                let (mut way, last) = (time * rate, if self.closed { count - 1 } else { count - 2 });
                if (way - math::rint(way)).abs() < ROUNDING * (1.0 + way) {
                    way = math::rint(way);
                }
                let before = (way as usize).min(last);
                let share = way - before as f64;
                let [from, to] = [before, (before + 1) % count].map(|frame| frame * self.points + point);
                let place = [0, 1, 2].map(|axis| mixed(places[from][axis], places[to][axis], share));
                let speed = rate * distance(places[to], places[from]);
                Moment { place, speed, target: mixed(targets[from], targets[to], share) }
            }
            Course::Beside(parts) => {
                let mut first = 0;
                let mut mine = parts.iter().filter_map(|part| {
                    let index = point.checked_sub(first).filter(|&index| index < part.points);
                    first += part.points;
                    index.map(|index| part.at(time, index))
                });
                mine.next().unwrap_or_default()
            }
            Course::Chain(links) => {
                let link = &links[links.partition_point(|link| link.start <= time).max(1) - 1];
                let idle = Moment { place: link.idle[point], ..Moment::default() };
                link.slots[point].map_or(idle, |index| link.path.at(time - link.start, index))
            }
            Course::Fade { places, before, after } => {
                let share = (1.0 - math::cos(PI * time / self.duration)) / 2.0;
                Moment { place: places[point], speed: 0.0, target: mixed(before[point], after[point], share) }
            }
            Course::Modulated(path, by) => {
                let moment = path.at(time, point);
                Moment { target: by.factor(by.frequency() * time) * moment.target, ..moment }
            }
        }
    }

    /// Returns all points (M,) at a time in s.
    pub fn moments(&self, time: f64) -> impl Iterator<Item = Moment> {
        (0..self.points).map(move |point| self.at(time, point))
    }

    /// Returns round(duration rate) frames at the times i / rate, i = 0, 1, ...; an open path has one more, its end.
    ///
    /// # Errors
    /// The errors of [`Path::count`].
    pub fn frames(&self, rate: f64) -> Result<PathFrames> {
        let moments = (0..self.count(rate)?).flat_map(|frame| self.moments(frame as f64 / rate));
        let (points, targets) = moments.map(|moment| (moment.place, moment.target)).unzip();
        Ok(PathFrames { points, targets })
    }

    /// Returns the number of frames at a rate in frames per second.
    ///
    /// # Errors
    /// A rate that gives fewer than two frames, too many at once, or too few for the modulation.
    pub fn count(&self, rate: f64) -> Result<usize> {
        frame_rate(rate)?;
        let refused = |cure: &str| Err(Error::out_of_range("rate", format_args!("{rate:?}"), cure));
        let count = math::rint(self.duration * rate) + f64::from(u8::from(!self.closed));
        if count < 2.0 {
            let lasts = figures(self.duration, 6);
            return refused(&format!("that is {count} frames in {lasts} s, give a larger one"));
        }
        if count * self.points as f64 > MOST_FRAMES {
            let large = format!("{} frames of {} points are too many for one answer", figures(count, 6), self.points);
            return refused(&format!("{large}, take them in parts by at(times) and targets(times)"));
        }
        let least = 2.0 * self.modulation;
        if rate < least * (1.0 - ROUNDING) {
            return refused(&format!("the modulation needs {least} frames a second at least, give as many"));
        }
        Ok(count as usize)
    }
}

getters! {
    Path:

    /// The number of points M.
    pub points(self) -> usize = self.points;

    /// The duration in s.
    pub duration(self) -> f64 = self.duration;

    /// Whether the end joins the start, so that the path can repeat.
    pub closed(self) -> bool = self.closed;

    /// Whether targets are in Pa; otherwise they are factors.
    pub pascals(self) -> bool = self.pascals;
}

/// Returns linear interpolation: `before` at share 0, `after` at share 1, exactly there and where both are equal.
fn mixed(before: f64, after: f64, share: f64) -> f64 {
    if share == 1.0 { after } else { before + share * (after - before) }
}

/// Returns targets (frames, points): pressures in Pa that are one number, one for each point, or one for each point and frame;
/// 1 without pressures.
fn spread(pressures: Option<&[f64]>, frames: usize, points: usize) -> Result<Vec<f64>> {
    let all = frames * points;
    let Some(list) = pressures else { return Ok(vec![1.0; all]) };
    if let Some(k) = list.iter().position(|&each| !(each >= 0.0 && each.is_finite())) {
        let item = if list.len() == 1 { "pressures".into() } else { format!("pressures[{k}]") };
        return Err(Error::out_of_range(item, format_args!("{:?}", list[k]), "give numbers of at least 0 in Pa"));
    }
    if ![1, points, all].contains(&list.len()) {
        let more = if frames > 1 { format!(" or {frames} x {points}") } else { String::new() };
        let cure = format!("give one number or {points}{more} in Pa");
        return Err(Error::invalid("pressures", format!("{} numbers", list.len()), cure));
    }
    Ok(list.iter().copied().cycle().take(all).collect())
}

/// Returns the duration in s of `way` m in `runs` runs, from a speed in m/s or a frequency in runs per second.
fn lasting(way: f64, runs: f64, speed: Option<f64>, frequency: Option<f64>) -> Result<f64> {
    if !(way > 0.0 && way.is_finite()) {
        let value = format!("{} m long", figures(way, 6));
        return Err(Error::invalid("the way", value, "give a path of a finite length above 0"));
    }
    either(["speed", "frequency"], [speed, frequency], "give speed in m/s, or frequency in Hz")?;
    let (item, pace, of) = speed.map_or(("frequency", frequency, runs), |speed| ("speed", Some(speed), way));
    let pace = real(item, pace.unwrap_or_default(), 0.0, true)?;
    let duration = of / pace;
    if duration > 0.0 && duration.is_finite() {
        return Ok(duration);
    }
    Err(Error::out_of_range(item, format_args!("{pace:?}"), format!("the path would last {duration} s, give another")))
}

/// Checks that exactly one of two numbers is given.
fn either(names: [&str; 2], values: [Option<f64>; 2], cure: &str) -> Result<()> {
    let [one, other] = names;
    match values {
        [Some(first), Some(second)] => {
            let value = format!("{first} and {other} is {second}");
            Err(Error::invalid(one, value, "give one of them, leave out the other"))
        }
        [None, None] => Err(Error::invalid(one, format!("left out, and so is {other}"), cure)),
        _ => Ok(()),
    }
}

/// Returns the rate of frames if `count` of them take a duration in s.
fn rate_of(count: f64, duration: f64) -> Result<f64> {
    let rate = count / real("duration", duration, 0.0, true)?;
    if rate.is_finite() {
        Ok(rate)
    } else {
        Err(Error::invalid("duration", format_args!("{duration:?}"), "give a longer one"))
    }
}

/// Checks that there are places, and that all are finite and not too far away.
fn check_set(item: &str, places: &[[f64; 3]]) -> Result<()> {
    refuse_if!(places.is_empty(), Error::invalid(item, "an empty list", "give points x 3 finite numbers in m"));
    near(places, |k| format!("{item}[{k}]"))
}

/// Checks that places are finite and not too far away; `name` gives the name of a place in errors.
fn near(places: &[[f64; 3]], name: impl Fn(usize) -> String) -> Result<()> {
    match places.iter().position(|place| !place.iter().all(|x| x.abs() <= FARTHEST)) {
        None => Ok(()),
        Some(k) => {
            let cure = format!("give three finite numbers in m, at most {FARTHEST}");
            Err(Error::invalid(name(k), format_args!("{:?}", places[k]), cure))
        }
    }
}

#[cfg(test)]
#[path = "tests/path.rs"]
mod tests;
