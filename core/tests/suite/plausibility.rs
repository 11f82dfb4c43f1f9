//! Tests of warnings about probable mistakes: each mistake gives one warning with its unit, usual arrays give none.

use midair::presets::PRESETS;
use midair::{Array, Bead, Directivity, Medium, Obstacle, Particle, Plane, Request, Scene, Surface, Transducer};

use crate::scenes::{preset, random_points, smiley};

fn points() -> Vec<[f64; 3]> {
    vec![[0.0, 0.0, 0.15], [0.02, 0.0, 0.15]]
}

fn reported(array: Array, medium: Medium, points: Vec<[f64; 3]>, pressures: Option<Vec<f64>>) -> Vec<String> {
    let scene = Scene::new(array, medium, points, Request { pressures, ..Request::default() }).expect("an answer");
    scene.doubts().iter().map(ToString::to_string).collect()
}

fn grid(pitch: f64) -> Array {
    Array::grid(10, 10, pitch).expect("a grid")
}

fn scaled(places: &[[f64; 3]], factor: f64) -> Vec<[f64; 3]> {
    places.iter().map(|place| place.map(|x| factor * x)).collect()
}

fn positions(places: Vec<[f64; 3]>) -> Array {
    Array::new(places, None).expect("positions")
}

#[test]
fn every_slip_of_a_unit_is_reported_once_with_its_cure() {
    let air = Medium::default();
    let board = || preset("autd3");
    let with = |change: fn(&mut Medium)| {
        let mut medium = Medium::default();
        change(&mut medium);
        reported(board(), medium, points(), None)
    };
    let source = |source_pressure: f64| {
        let transducer = Transducer { source_pressure, ..Transducer::default() };
        reported(board().with_transducer(transducer).expect("a pressure"), air, points(), None)
    };
    let kelvin = Medium::sound_speed_at(298.0).expect("a temperature");
    let at = |sound_speed: f64| reported(board(), Medium { sound_speed, ..Medium::default() }, points(), None);
    let millimetres = scaled(board().positions(), 1e3);
    for (texts, start, end) in [
        (
            reported(grid(10.5), air, points(), None),
            "array.grid.pitch is 10.5 m: no neighbours",
            "(10.5 mm are 0.0105 m)",
        ),
        (
            reported(grid(1.05), air, points(), None),
            "array.grid.pitch is 1.05 m: no neighbours",
            "(1.05 cm are 0.0105 m)",
        ),
        (
            reported(grid(1.05e-5), air, points(), None),
            "array.grid.pitch is 1.05e-5 m: neighbours nearer than",
            "give m",
        ),
        (
            reported(positions(millimetres.clone()), air, points(), None),
            "array.positions is 10.16 m and",
            "are 0.01016 m), or unit=\"mm\"",
        ),
        (
            reported(positions(millimetres), air, scaled(&points(), 1e3), None),
            "array.positions is 10.16 m and",
            "unit=\"mm\"",
        ),
        (
            reported(board(), air, scaled(&points(), 1e3), None),
            "points[0].position is [0, 0, 150] m (and 1 more): far beyond an array of 0.1727 m: ",
            "give m (150 mm are 0.15 m)",
        ),
        (with(|air| air.frequency = 40.0), "medium.frequency is 40 Hz: ", "give Hz (40 kHz are 40000 Hz)"),
        (with(|air| air.frequency = 40e6), "medium.frequency is 4e7 Hz: ", "give Hz"),
        (with(|air| air.absorption = 1.3), "medium.absorption is 1.3 Np/m: ", "(1.3 dB/m are 0.1497 Np/m)"),
        (with(|air| air.density = 1180.0), "medium.density is 1180 kg/m^3: ", "(1180 g/m^3 are 1.18 kg/m^3)"),
        (with(|air| air.density = 998.0), "medium.density is 998 kg/m^3: ", "are 0.998 kg/m^3)"),
        (at(kelvin), "medium.sound_speed is 479.1 m/s, that of air at 298 degrees C: ", "(298 K are 24.85), -60 to 60"),
        (at(34e3), "medium.sound_speed is 34000 m/s: air has 293 to 366 m/s", "give m/s (34000 cm/s are 340 m/s)"),
        (at(1500.0), "medium.sound_speed is 1500 m/s: air has 293 to 366 m/s", "give m/s"),
        (source(4386.0), "array.source_pressure is 4386 Pa m: ", "(4386 mPa m are 4.386 Pa m)"),
        (source(4.386e-3), "array.source_pressure is 0.004386 Pa m: ", "(0.004386 kPa m are 4.386 Pa m)"),
    ] {
        let [text] = &texts[..] else { panic!("one doubt of {start}: {texts:?}") };
        assert!(text.starts_with(start) && text.ends_with(end) && !text.contains('\n'), "{text}");
    }
}

#[test]
fn neighbours_are_found_wherever_they_lie() {
    let air = Medium::default();
    let two = |apart: [f64; 3]| {
        reported(
            positions(vec![[0.3, 0.1, 0.0], [0, 1, 2].map(|k| [0.3, 0.1, 0.0][k] + apart[k])]),
            air,
            points(),
            None,
        )
    };
    for axis in 0..3 {
        for (distance, expected) in [(0.0, "nearer"), (0.9 / 20.0, "nearer"), (1.1 / 20.0, ""), (4.9, "")] {
            let mut apart = [0.0; 3];
            apart[axis] = distance * air.wavelength();
            let texts = two(apart);
            assert_eq!(texts.len(), usize::from(!expected.is_empty()), "{distance} along {axis}: {texts:?}");
            assert!(texts.iter().all(|text| text.contains(expected)), "{distance} along {axis}: {texts:?}");
        }
    }
    // Four transducers have neighbours. Two loudspeakers may be anywhere, unless their places are in mm.
    let four = |apart: f64| positions((0..4).map(|k| [apart * f64::from(k), 0.0, 0.0]).collect());
    assert!(reported(four(4.9 * air.wavelength()), air, points(), None).is_empty());
    assert!(reported(four(5.1 * air.wavelength()), air, points(), None)[0].contains("no neighbours"));
    assert!(two([0.087, 0.0, 0.0]).is_empty());
    assert!(two([8.7, 0.0, 0.0])[0].ends_with("give m (8.7 mm are 0.0087 m), or unit=\"mm\""));
    // One mistake among many positions, and very large arrays, are found fast.
    let mut many = grid(0.01).positions().to_vec();
    many.push([0.0051, 0.0049, 0.0]);
    assert!(reported(positions(many), air, points(), None)[0].contains(" m from [55] to [100]: neighbours nearer"));
    let million = Array::grid(1024, 1024, 8e-3).expect("a grid");
    let texts = reported(million, air, points(), None);
    assert!(texts.is_empty(), "{texts:?}");
    assert!(
        reported(Array::grid(2, 2000, 0.01).expect("a grid"), air, points(), None)[0]
            .contains("positions is 19.99 m wide")
    );
}

#[test]
fn two_pressures_in_one_place_are_reported_and_what_a_wave_can_do_is_not() {
    let air = Medium::default();
    let near = |distance: f64, pressures: [f64; 2]| {
        let mut places = random_points(30, 0.08, 3);
        let mut requested = vec![300.0; 30];
        places.extend([[0.0, 0.0, 0.15], [distance * air.wavelength(), 0.0, 0.15]]);
        requested.extend(pressures);
        reported(preset("autd3"), air, places, Some(requested))
    };
    for (distance, pressures) in
        [(0.0, [500.0, 0.0]), (0.0, [500.0, 490.0]), (0.09, [500.0, 0.0]), (0.02, [100.0, 300.0])]
    {
        let texts = near(distance, pressures);
        let [text] = &texts[..] else { panic!("{distance} {pressures:?}: {texts:?}") };
        assert!(text.starts_with(&format!("points[30].pressure is {} Pa, ", pressures[0])), "{text}");
        assert!(text.contains(&format!(" m from points[31] with {} Pa", pressures[1])), "{text}");
    }
    for (distance, pressures) in
        [(0.0, [500.0, 500.0]), (0.09, [500.0, 400.0]), (0.11, [500.0, 0.0]), (0.01, [0.0, 0.0])]
    {
        assert_eq!(near(distance, pressures), [""; 0], "{distance} {pressures:?}");
    }
    // A point of weight 0 is ignored. Thousands of points at one place are checked in limited time.
    let heap = |last: f64| {
        let pressures = (0..20_000).map(|j| if j == 17 { last } else { 500.0 }).collect();
        let request = Request { pressures: Some(pressures), ..Request::default() };
        Scene::new(preset("autd3"), air, vec![[0.0, 0.0, 0.15]; 20_000], request).expect("a scene").doubts().len()
    };
    assert_eq!([heap(500.0), heap(0.0)], [0, 1]);
    let request = Request { pressures: Some(vec![500.0, 0.0]), weights: Some(vec![1.0, 0.0]), ..Request::default() };
    let scene = Scene::new(preset("autd3"), air, vec![[0.0, 0.0, 0.15]; 2], request).expect("a scene");
    assert_eq!(scene.doubts(), []);
}

#[test]
fn beads_in_millimetres_are_reported() {
    let doubts = |radius: f64, frequency: f64| {
        let medium = Medium { frequency, ..Medium::default() };
        let scene = Scene::new(preset("autd3"), medium, points(), Request::default()).expect("a scene");
        let bead = Bead { particle: Particle { radius, ..Particle::default() }, ..Bead::default() };
        scene.with_bead(bead).expect("a bead").doubts().iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    assert_eq!(
        doubts(1.0, 40e3),
        ["bead.radius is 1 m: larger than the wavelength of 0.0085 m: give m (1 mm are 0.001 m)"]
    );
    assert!(doubts(5e-3, 40e3).is_empty());
    // The default bead is not judged, even where it is larger than the wavelength.
    assert!(!doubts(1e-3, 500e3).iter().any(|text| text.starts_with("bead")));
}

#[test]
fn planes_in_millimetres_are_reported() {
    let plane = |z: f64, size: f64| Plane::new(z, size, 10, [0.0, 0.0]).expect("a plane").doubt();
    assert!(plane(0.15, 0.1).is_none() && plane(-1.0, 5.0).is_none());
    assert_eq!(plane(150.0, 100.0).expect("a warning").to_string(), "plane.z is 150 m: give m (150 mm are 0.15 m)");
    assert_eq!(plane(0.15, 100.0).expect("a warning").to_string(), "plane.size is 100 m: give m (100 mm are 0.1 m)");
}

#[test]
fn presets_tiles_and_the_papers_scenes_are_nobodys_slip() {
    for entry in &PRESETS {
        for frequency in [20e3, 40e3, 80e3] {
            let medium = Medium { frequency, sound_speed: 331.3, absorption: 0.15, density: 1.29 };
            let texts = reported(preset(entry.name), medium, smiley(), Some(vec![0.2; 38]));
            assert!(texts.is_empty(), "{}: {texts:?}", entry.name);
        }
    }
    let room = Array::preset("autd3", [8, 8]).expect("tiles");
    assert_eq!(reported(room, Medium::default(), vec![[1.0, 2.0, 3.0]], None), [""; 0]);
}

#[test]
fn points_behind_every_transducer_are_doubted() {
    let air = Medium::default();
    let behind = |name: &str, point: [f64; 3]| reported(preset(name), air, vec![point], None);
    for name in ["autd3", "sonicsurface", "paper20", "openmpd_board"] {
        let text = &behind(name, [0.0, 0.0, -0.12])[0];
        assert!(text.starts_with("points[0].position is [0, 0, -0.12] m: behind every transducer"), "{name}: {text}");
    }
    // Between two boards, each point is in front of one of them.
    let heights: Vec<f64> = preset("openmpd_pair").positions().iter().map(|place| place[2]).collect();
    let middle = heights.iter().sum::<f64>() / heights.len() as f64;
    assert!(behind("openmpd_pair", [0.0, 0.0, middle]).is_empty());
    // A board sends no sound along its own plane.
    let text = &behind("autd3", [0.3, 0.0, 0.0])[0];
    assert!(text.starts_with("points[0].position is [0.3, 0, 0] m: in the plane of the transducers"), "{text}");
}

#[test]
fn points_beside_a_transducer_are_doubted() {
    let near = |x, z| reported(Array::grid(2, 2, 10e-3).unwrap(), Medium::default(), vec![[x, 5e-3, z]], None);
    let text = "points[0].position is [0.005, 0.005, 0.002] m, 0.002 m from transducer 3: nearer than a quarter";
    assert!(near(5e-3, 2e-3)[0].starts_with(text), "{:?}", near(5e-3, 2e-3));
    assert!(near(0.0, 2e-3).is_empty() && near(5e-3, 3e-3).is_empty());
}

fn pistons(radius: f64, n: usize, pitch: f64) -> Array {
    let transducer = Transducer { directivity: Directivity::piston(radius), ..Transducer::default() };
    Array::grid(n, n, pitch).unwrap().with_transducer(transducer).unwrap()
}

/// |p| r of a piston of radius a at a distance r and an angle, relative to its far field on the axis: Rayleigh's integral.
fn rayleigh(a: f64, k: f64, r: f64, theta: f64) -> f64 {
    let (x, z, rings, sectors) = (r * theta.sin(), r * theta.cos(), 60, 60);
    let mut sum = num_complex::Complex64::default();
    for ring in 0..rings {
        let s = a * (f64::from(ring) + 0.5) / f64::from(rings);
        for sector in 0..sectors {
            let turn = std::f64::consts::TAU * (f64::from(sector) + 0.5) / f64::from(sectors);
            let away = (x * x + s * s - 2.0 * x * s * turn.cos() + z * z).sqrt();
            sum += num_complex::Complex64::from_polar(s / away, k * away);
        }
    }
    sum.norm() * r * 2.0 / (a * f64::from(rings) * f64::from(sectors))
}

#[test]
fn points_in_the_near_field_of_a_piston_are_doubted() {
    let air = Medium::default();
    let k = air.wavenumber();
    for a in [5e-3, 10e-3, 16e-3] {
        let near = |r: f64| reported(pistons(a, 2, 0.04), air, vec![[0.02, 0.02, r]], None);
        let reach = k * a * a / 2.0;
        assert!(near(1.001 * reach).is_empty(), "{:?}", near(1.001 * reach));
        let text = &near(0.999 * reach)[0];
        assert!(text.contains("nearer than k a^2/2 = ") && text.contains("of a piston of radius"), "{text}");
        // The far field is right to 11 % of its value on the axis beyond, and wrong by 5 % and more at 0.8 of this length.
        let off = |r: f64, degrees: i32| {
            let theta = f64::from(degrees).to_radians();
            (rayleigh(a, k, r, theta) - Directivity::piston(a).value(theta.cos(), k).abs()).abs()
        };
        let most = |part: f64| (0..89).step_by(3).map(|degrees| off(part * reach, degrees)).fold(0.0, f64::max);
        assert!(most(1.0) < 0.11 && most(2.0) < 0.05, "{} {}", most(1.0), most(2.0));
        assert!(off(0.8 * reach, 0) > 0.05, "{}", off(0.8 * reach, 0));
    }
}

#[test]
fn pistons_wider_than_their_distance_are_doubted() {
    let warned = |radius, pitch| reported(pistons(radius, 4, pitch), Medium::default(), points(), None);
    let text = "directivity.piston is a radius of 0.009 m: wider than the 0.01 m from one transducer to the next: \
                give the radius (a diameter of 0.009 m is a radius of 0.0045 m)";
    assert_eq!(warned(9e-3, 0.01), [text]);
    assert_eq!(warned(6e-3, 0.01).len(), 1);
    assert!(warned(5e-3, 0.01).is_empty() && warned(4.5e-3, 0.0105).is_empty());
}

#[test]
fn obstacles_in_millimetres_are_doubted() {
    let scene = || Scene::new(grid(0.01), Medium::default(), points(), Request::default()).unwrap();
    let reported = |obstacle| {
        scene().with_obstacles(vec![obstacle]).unwrap().doubts().iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    let wall = |x| Obstacle::Wall { point: [x, 0.0, 0.0], normal: [-2.0, 0.0, 0.0], kind: Surface::Rigid };
    let text = &reported(wall(45.0))[0];
    assert!(text.starts_with("obstacles[0] is 45 m from the array: give m (45 mm are 0.045 m)"), "{text}");
    assert!(reported(wall(5.0)).is_empty());
    let sphere = |z| Obstacle::Sphere { center: [0.0, 0.0, z], radius: 0.02, kind: Surface::Rigid };
    assert!(
        reported(sphere(150.0))[0].starts_with("obstacles[0] is 150 m from the array"),
        "{:?}",
        reported(sphere(150.0))
    );
}
