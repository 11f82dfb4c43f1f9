//! Judging: computes the metrics of many drives, each at its own points, sixteen at a time, over all threads.

use crate::problem::{Metrics, Precision};
use crate::session::worker::{Requests, Task, Worker};
use crate::session::{Session, SolveRequest};
use crate::solvers::common::interleaved_batch;
use crate::solvers::prelude::*;

/// Consecutive drives, and where their metrics are written.
struct Judged<'a> {
    /// The index of the first drive in the batch.
    first: usize,
    drives: &'a [Complex32],
    metrics: &'a mut [Metrics],
}

impl Session {
    /// Returns the metrics of `count` drives (B, N). `ask` writes the points and the request of a drive, given its
    /// index; every request has `points` points. Each result has the same bits as [`crate::Problem::judge`], whatever
    /// the number of threads.
    ///
    /// `control` is called after every few drives, with the mean residual so far. After a stop, the metrics of the remaining
    /// drives are NaN.
    ///
    /// # Errors
    /// `drives` of another length; the error of the first drive or request that is rejected, with its index.
    ///
    /// ```
    /// use midair::{Array, Complex32, Control, InstructionSet, Medium, Model, Precision, Session, SolveRequest, solvers};
    ///
    /// let model = Model::new(&Array::preset("paper20", [1, 1])?, Medium::default(), InstructionSet::best())?;
    /// let mut session = Session::new(model, solvers::find("fast")?.configure(&[].into())?.solver, true);
    /// let ask = |k: usize, ask: &mut SolveRequest| {
    ///     ask.points = vec![[0.0, 0.0, 0.1 + 1e-3 * k as f64]];
    ///     Ok(())
    /// };
    /// let drives = vec![Complex32::ONE; 20 * 400];
    /// let metrics = session.judge_batch(20, 1, &ask, &drives, Precision::Single, &mut Control::none())?;
    /// assert!(metrics.iter().all(|metrics| metrics.accuracy > 0.0 && metrics.accuracy < 1.0));
    /// # Ok::<(), midair::Error>(())
    /// ```
    pub fn judge_batch(
        &mut self,
        count: usize,
        points: usize,
        ask: &(dyn Fn(usize, &mut SolveRequest) -> Result<()> + Sync),
        drives: &[Complex32],
        precision: Precision,
        control: &mut Control,
    ) -> Result<Vec<Metrics>> {
        let taken = bytes(size_of::<Metrics>(), &[count]);
        let (transducers, threads, share) = self.shared_out(count, points, drives.len(), taken, control)?;
        let (task, requests) = (&self.task, Requests { points, ask });
        let workers = &mut self.workers[..threads];
        let mut metrics = vec![Metrics::from_values([f64::NAN; 6]); count];
        let mut done = 0;
        while done < count {
            let end = count.min(done + share * threads);
            let lists = drives[done * transducers..end * transducers].chunks(share * transducers);
            let lists = lists.zip(metrics[done..end].chunks_mut(share)).enumerate();
            let parts = lists.map(|(k, (drives, metrics))| Judged { first: done + k * share, drives, metrics });
            let run = |(part, worker): (Judged<'_>, &mut Worker), control: &mut Control| {
                worker.judge(part, task, requests, precision, control)
            };
            match control.each(parts.zip(&mut *workers).collect(), &run) {
                Err(error) if error.is_stop() => break,
                outcome => outcome?,
            }
            done = end;
            let residuals = metrics[..done].iter().map(|metrics| metrics.residual);
            if control.step(done, count, || residuals.clone().sum::<f64>() / done as f64).is_break() {
                break;
            }
        }
        Ok(metrics)
    }
}

impl Worker {
    /// Reads the problems of a part and computes the metrics of their drives.
    fn judge(
        &mut self,
        Judged { first, drives, metrics }: Judged<'_>,
        task: &Task,
        requests: Requests<'_>,
        precision: Precision,
        control: &mut Control,
    ) -> Result<()> {
        let transducers = drives.len() / metrics.len();
        for (k, (drives, metrics)) in drives.chunks(LANES * transducers).zip(metrics.chunks_mut(LANES)).enumerate() {
            control.pulse()?;
            let (count, refused) = self.prepare(first + k * LANES, metrics.len(), task, requests, control);
            let judged = self.judge_prepared(count, drives, precision, metrics, control);
            judged.and(refused).map_err(|(index, error)| error.of_one("problems", first + k * LANES + index))?;
        }
        Ok(())
    }

    /// Computes the metrics of the drives of the first `count` problems. An error comes with the index of its problem.
    fn judge_prepared(
        &mut self,
        count: usize,
        drives: &[Complex32],
        precision: Precision,
        metrics: &mut [Metrics],
        control: &mut Control,
    ) -> Result<(), (usize, Error)> {
        let (problems, transducers) = (&self.problems[..count], drives.len() / metrics.len());
        let mut pairs = drives.chunks(transducers).zip(problems).enumerate();
        let columns = |problem: &crate::problem::Problem, drive: &[Complex32]| {
            problem.setup().columns(drive, problem.propagation().transducers()).map(drop)
        };
        pairs.try_for_each(|(k, (drive, problem))| columns(problem, drive).map_err(|error| (k, error)))?;
        if precision == Precision::Single
            && let Some([re, im]) = interleaved_batch::fields(problems, drives, &self.work)
        {
            let [re, im] = [&re, &im].map(|part| part.as_chunks::<LANES>().0);
            for (lane, (problem, metrics)) in problems.iter().zip(metrics).enumerate() {
                *metrics = problem.metrics_of(re.iter().map(|re| &re[lane]).zip(im.iter().map(|im| &im[lane])));
            }
            return Ok(());
        }
        for (k, (problem, metrics)) in problems.iter().zip(metrics).enumerate() {
            let drive = &drives[k * transducers..(k + 1) * transducers];
            *metrics = problem.judge(drive, precision, control).map_err(|error| (k, error))?;
        }
        Ok(())
    }
}
