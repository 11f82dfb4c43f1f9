//! Tests every instruction set: rows, fields and solutions agree with the propagation matrix in f64, for any number of points.

use crate::{Allowed, Draw, one_line};
use midair::{Control, Error, InstructionSet, Model, Problem, Setup, Workspace};

/// Runs the test that the bytes describe.
pub fn check(bytes: &[u8]) {
    one_line(run(&mut Draw::new(bytes)));
}

fn run(draw: &mut Draw) -> Result<(), Error> {
    let (array, medium) = (draw.array()?, draw.medium()?);
    let points = draw.points(70);
    let request = draw.request(points.len());
    let drive = draw.drive(array.len());
    let configured = draw.solver(array.quantization(), array.len())?;
    let allowed = Allowed::of(&array, medium, &points);
    let mut answers = InstructionSet::all().map(|set| {
        let model = Model::new(&array, medium, set)?;
        let propagation = model.propagation(&points)?;
        let setup = Setup::of(&array, medium);
        let problem = Problem::with_propagation(propagation.clone(), setup, &request)?;
        allowed.check_rows(&propagation);
        if let Some(field) = one_line(midair::field(&model, &drive, &points, &mut Control::none())) {
            allowed.check_field(&propagation, &drive, 1.0, &field, set.name());
        }
        let (work, none) = (&mut Workspace::new(), &mut Control::none());
        let solution = midair::solve(&problem, &*configured.solver, configured.info.balance, work, none)?;
        allowed.check_field(&propagation, &solution.drive, solution.scale, &solution.pressures, set.name());
        Ok((problem.balance(), allowed.doubt(&propagation)))
    });
    let first: Result<(f64, f64), Error> = answers.next().expect("scalar");
    for other in answers {
        let doubts = [&first, &other].map(|answer| answer.as_ref().map_or(0.0, |(_, doubt)| *doubt));
        if doubts.into_iter().any(|doubt| doubt >= 1.0) {
            // If a level may consist of rounding errors only, it can be 0 in one instruction set and above 0 in another.
            continue;
        }
        match (&first, other) {
            (Ok((balance, doubt)), Ok((other, _))) => {
                assert!((other / balance - 1.0).abs() < *doubt, "balanced by {other} for {balance}");
            }
            (first, other) => assert_eq!(first.as_ref().err(), other.as_ref().err()),
        }
    }
    Ok(())
}
