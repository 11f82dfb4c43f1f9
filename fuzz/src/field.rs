//! Tests field, judge, reach, bound and the planes of pictures: their numbers agree, or there is an error of one line.

use crate::{Allowed, Draw, one_line};
use midair::{Control, Error, InstructionSet, Model, Precision, Problem, Scene};

/// Runs the test that the bytes describe.
pub fn check(bytes: &[u8]) {
    one_line(run(&mut Draw::new(bytes)));
}

fn run(draw: &mut Draw) -> Result<(), Error> {
    let (array, medium, points) = (draw.array()?, draw.medium()?, draw.points(9));
    let request = draw.request(points.len());
    let scene = Scene::new(array, medium, points, request)?;
    let model = Model::of(&scene, InstructionSet::best());
    let none = &mut Control::none();
    let drive = draw.drive(scene.array().len());
    // The places may be anywhere, also on a transducer.
    let places = draw.points(20);
    let field = midair::field(&model, &drive, &places, none)?;
    assert!(field.iter().all(|p| p.re.is_finite() && p.im.is_finite()), "{field:?}");
    for plane in scene.picture_planes() {
        assert!([0, 1].iter().all(|&side| plane.samples(side).iter().all(|x| x.is_finite())), "{plane:?}");
    }
    let problem = Problem::new(&scene)?;
    let propagation = model.propagation(scene.points())?;
    let here = midair::field(&model, &drive, scene.points(), none)?;
    let allowed = Allowed::of(scene.array(), medium, scene.points());
    allowed.check_field(&propagation, &drive, 1.0, &here, "field");
    let reach = problem.reach(none)?;
    assert!(reach.alone.iter().chain(&reach.level).all(|p| p.is_finite() && *p >= 0.0), "{reach:?}");
    if let Some(beyond) = problem.beyond(none)? {
        one_line::<()>(Err(Error::invalid("points", "beyond", beyond.to_string())));
    }
    let metrics = problem.judge(&drive, Precision::Double, none)?;
    let bound = midair::bound(&problem, none)?;
    // The bound is 0 if no transducer reaches the points.
    assert!(bound >= 0.0, "{bound}");
    let least = metrics.level * metrics.uniformity;
    // Let x be |p| / target of a point. min x is uniformity times max x, and max x is at least the mean x.
    assert!(least <= bound * (1.0 + 1e-6), "a level of {least} above the bound {bound}");
    Ok(())
}
