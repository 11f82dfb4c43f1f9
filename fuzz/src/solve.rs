//! Tests the solvers: any array or matrix, request and options give a valid solution or an error of one line.

use crate::{Allowed, Draw, one_line};
use midair::{Complex64, Control, Error, InstructionSet, Model, Problem, Propagation, Setup, Workspace};

/// Runs the test that the bytes describe.
pub fn check(bytes: &[u8]) {
    one_line(run(&mut Draw::new(bytes)));
}

fn run(draw: &mut Draw) -> Result<(), Error> {
    let sets: Vec<InstructionSet> = InstructionSet::all().collect();
    let set = draw.one(&sets);
    let (propagation, setup, allowed) = if draw.whole(0, 3) > 0 { computed(draw, set)? } else { given(draw)? };
    let propagation = propagation.with_instruction_set(set);
    let (points, transducers) = (propagation.points(), propagation.transducers());
    let configured = draw.solver(setup.quantization.as_deref(), transducers)?;
    let mut problem = Problem::with_propagation(propagation.clone(), setup, &draw.request(points))?;
    if let Some(start) = draw.maybe(|draw| draw.start(transducers, points)) {
        problem = problem.with_start(start)?;
    }
    if let Some(aim) = draw.maybe(Draw::aim) {
        problem = problem.with_aim(aim);
    }
    let work = &mut Workspace::new();
    let solution = midair::solve(&problem, &*configured.solver, draw.flag(), work, &mut Control::none())?;
    allowed.check(&problem, &propagation, &solution, configured.info.name);
    // A second solve in the same memory gives the same bits.
    let balance = configured.info.balance;
    let [first, second] =
        [(); 2].map(|()| midair::solve(&problem, &*configured.solver, balance, work, &mut Control::none()));
    let (first, second) = (first?, second?);
    assert_eq!((&first.drive, &first.pressures), (&second.drive, &second.pressures), "{}", configured.info.name);
    Ok(())
}

/// Returns the propagation matrix G of an array at some points.
fn computed(draw: &mut Draw, set: InstructionSet) -> Result<(Propagation, Setup, Allowed), Error> {
    let (array, medium) = (draw.array()?, draw.medium()?);
    let points = draw.points(40);
    let propagation = Model::new(&array, medium, set)?.propagation(&points)?;
    Ok((propagation, Setup::of(&array, medium), Allowed::of(&array, medium, &points)))
}

/// Returns a user's own propagation matrix G; its entries have one order of magnitude, or many.
fn given(draw: &mut Draw) -> Result<(Propagation, Setup, Allowed), Error> {
    let (points, transducers) = (draw.whole(1, 20), draw.whole(1, 40));
    let (unit, many) = (draw.wide(), draw.flag());
    let part = |draw: &mut Draw| if many { draw.wide() } else { draw.real(1.0) * unit };
    let matrix = draw.list(points * transducers, |draw| Complex64::new(part(draw), part(draw)));
    let mut propagation = Propagation::from_matrix(&matrix, points)?;
    if let Some(mask) = draw.maybe(|draw| draw.list(transducers, Draw::flag)) {
        propagation = propagation.with_mask(&mask)?;
    }
    let quantization = draw.maybe(Draw::quantization).transpose()?.map(Into::into);
    let positions = draw.maybe(|draw| draw.list(transducers, Draw::place).into());
    let allowed = Allowed::given(&propagation);
    Ok((propagation, Setup { medium: draw.medium()?, quantization, positions, ..Setup::default() }, allowed))
}
