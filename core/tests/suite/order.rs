//! Tests of the order of transducers on boards: random orders, places, motions and pins against every kind of board.

use core::f32::consts::TAU;

use midair::{Array, Board, Complex32, ErrorCode, Pose, Rng, presets::PRESETS};

fn shuffled(rng: &mut Rng, count: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    for i in (1..count).rev() {
        order.swap(i, (rng.next_u64() % (i as u64 + 1)) as usize);
    }
    order
}

fn picked(array: &Array, order: &[usize]) -> Array {
    let pick = |list: &[[f64; 3]]| order.iter().map(|&i| list[i]).collect();
    Array::new(pick(array.positions()), Some(pick(array.normals()))).expect("an array")
}

/// A random rotation and translation; the quaternion's parts are even, which suffices here.
fn anywhere(rng: &mut Rng) -> Pose {
    let [w, x, y, z, a, b, c] = core::array::from_fn(|_| 2.0 * rng.uniform() - 1.0);
    Pose::new(&[w, x, y, z], [a, b, c]).expect("a pose")
}

/// Every array whose order a kind of board knows, alone and twice, each with its kind.
fn known() -> Vec<(&'static str, Array)> {
    let presets = PRESETS.iter().filter_map(|preset| Some((preset.board?, Array::preset(preset.name, [1, 1]).ok()?)));
    let grids = ["nano", "nano16", "homies"].map(|kind| (kind, Array::of_board(kind, [1, 1]).expect(kind)));
    presets.chain(grids).chain([("autd3", Array::preset("autd3", [2, 1]).expect("boards"))]).collect()
}

#[test]
fn the_boards_own_order_is_accepted_wherever_it_stands() {
    let mut rng = Rng::new(1);
    for (kind, array) in known() {
        for _ in 0..4 {
            let moved = array.moved(&anywhere(&mut rng)).expect("moved");
            let board = moved.board(kind).unwrap_or_else(|error| panic!("{kind}: {error}"));
            assert_eq!(board.channels(), Board::new(kind, array.len()).expect(kind).channels());
            let mut near = || moved.positions().iter().map(|p| p.map(|x| x + 2e-3 * (rng.uniform() - 0.5))).collect();
            let measured = Array::new(near(), Some(moved.normals().to_vec())).expect("measured places");
            assert!(measured.board(kind).is_ok(), "{kind}");
        }
    }
}

#[test]
fn no_other_order_reaches_a_board() {
    let mut rng = Rng::new(2);
    for (kind, array) in known() {
        let standard = Board::new(kind, array.len()).expect(kind);
        // Each board is shuffled by itself; homies has two FPGAs on one board.
        let size = if array.len() == 512 {
            256
        } else if array.len() == 498 {
            249
        } else {
            array.len()
        };
        for _ in 0..6 {
            let order: Vec<usize> = (0..array.len() / size)
                .flat_map(|k| shuffled(&mut rng, size).into_iter().map(move |i| k * size + i))
                .collect();
            let mixed = picked(&array.moved(&anywhere(&mut rng)).expect("moved"), &order);
            let error = mixed.board(kind).err().unwrap_or_else(|| panic!("{kind} takes another order"));
            assert_eq!(error.code, ErrorCode::Conflict, "{kind}: {error}");
            assert!(
                error.to_string().starts_with(&format!("array is in another order than {kind}: give its transducers"))
            );
            // The channels by place put the array into the board's order, at its places.
            let channels = mixed.channels_by_place(kind).expect(kind);
            let mut placed = vec![0; array.len()];
            for (i, channel) in channels.iter().enumerate() {
                placed[standard.channels().iter().position(|own| own == channel).expect("a channel")] = i;
            }
            assert!(picked(&mixed, &placed).board(kind).is_ok(), "{kind}");
            // So do pins, and channels that are stated.
            let pinned = mixed.clone().with_pins(Some(channels.clone())).expect("pins");
            assert_eq!(pinned.board(kind).expect(kind).channels(), channels);
            assert_eq!(mixed.board_on(kind, channels.clone()).expect(kind).channels(), channels);
        }
    }
}

#[test]
fn mirrored_rows_and_columns_are_another_order() {
    for (kind, array, side) in [
        ("sonicsurface", Array::preset("sonicsurface", [1, 1]), 16),
        ("openmpd", Array::preset("openmpd_board", [1, 1]), 16),
        ("mega64", Array::preset("ultraino_flat8x8", [1, 1]), 8),
        ("nano16", Array::of_board("nano16", [1, 1]), 4),
    ] {
        let array = array.expect(kind);
        let of = |place: &dyn Fn(usize, usize) -> usize| {
            let order: Vec<usize> = (0..side * side).map(|i| place(i / side, i % side)).collect();
            picked(&array, &order).board(kind)
        };
        for mirrored in [
            of(&|row, column| side * column + row),
            of(&|row, column| side * row + side - 1 - column),
            of(&|row, column| side * (side - 1 - row) + column),
        ] {
            assert_eq!(mirrored.err().expect("another order").code, ErrorCode::Conflict, "{kind}");
        }
        // Half a turn of a square is a motion.
        assert!(of(&|row, column| side * (side - 1 - row) + side - 1 - column).is_ok(), "{kind}");
    }
}

#[test]
fn other_places_and_numbers_are_refused_where_places_are_fixed() {
    let refused = |array: Result<Array, midair::Error>, kind: &str| {
        array.expect("an array").board(kind).err().map_or_else(String::new, |error| error.to_string())
    };
    let all = |pitch: f64| Array::grid(16, 16, pitch);
    assert_eq!(
        refused(all(11.2e-3), "sonicsurface"),
        "array.positions[255] is 7.425 mm from its place: give the places and order of sonicsurface, to 3 mm, or channels= of \
         a Board"
    );
    assert_eq!(refused(all(10.7e-3), "sonicsurface"), "");
    assert_eq!(
        refused(Array::grid(20, 20, 10e-3), "autd3"),
        "array has 400 transducers: each autd3 has 249: give whole boards, with a mask= for what is off"
    );
    let preset = Array::preset("autd3", [1, 1]).expect("a board");
    let down = Array::new(preset.positions().to_vec(), Some(vec![[0.0, 0.0, -1.0]; 249]));
    assert_eq!(
        refused(down, "autd3"),
        "array.positions[0] is where it belongs, but faces another way: give the places and order of autd3, to 3 mm, or \
         channels= of a Board"
    );
    // Boards that each owner wires take any other places.
    assert_eq!(refused(Array::grid(8, 8, 12e-3), "mega64"), "");
    assert_eq!(refused(Array::grid(5, 3, 10e-3), "nano16"), "");
}

#[test]
fn pins_are_the_channels_of_boards_that_owners_wire() {
    let array = Array::preset("ultraino_flat8x8", [1, 1]).expect("an array");
    let pinned = |pins: Vec<usize>| array.clone().with_pins(Some(pins));
    let backwards: Vec<usize> = (0..64).rev().collect();
    assert_eq!(pinned(backwards.clone()).expect("pins").board("mega64").expect("a board").channels(), backwards);
    // A pin of the second board of a chain.
    let chain: Vec<usize> = (0..64).map(|i| 100 * (i % 2) + i / 2).collect();
    let board = pinned(chain.clone()).expect("pins").board("mega64").expect("a chain");
    assert_eq!((board.boards(), board.channels()), (3, &*chain));
    assert_eq!(
        pinned((0..64).map(|i| i % 63).collect()).unwrap_err().to_string(),
        "array.pins[63] is 0: array.pins[0] is the same: give each once"
    );
    assert_eq!(
        pinned((0..64).map(|i| 14 * i).collect()).expect("pins").board("mega64").err().map(|error| error.to_string()),
        None
    );
    let far = pinned((0..64).map(|i| 20 * i).collect()).expect("pins").board("mega64");
    assert_eq!(far.err().expect("too far").to_string(), "channels[45] is 900: give channels of 0 to 895");
    let both = pinned(backwards).and_then(|array| array.with_channels(Some(vec![0; 64]))).expect("an array");
    assert!(
        both.board("mega64").err().expect("refused").to_string().starts_with("array.pins is given with array.channels")
    );
}

#[test]
fn bytes_correct_the_delays_that_an_array_lacks() {
    let mut rng = Rng::new(7);
    let surface = Array::preset("sonicsurface", [1, 1]).expect("a board");
    let up = Pose::new(&[0.0, core::f64::consts::PI, 0.0], [0.0, 0.0, 0.243]).expect("a pose");
    let pair = Array::join(&[surface.clone(), surface.moved(&up).expect("moved")]).expect("a pair");
    let flat = Array::preset("ultraino_flat8x8", [1, 1]).expect("a board");
    let pins = shuffled(&mut rng, 64);
    let wired = Array::new(flat.positions().to_vec(), None).and_then(|array| array.with_pins(Some(pins.clone())));
    let delays = |name| Array::preset(name, [1, 1]).expect(name).response().expect("delays").to_vec();
    let flat_delays = delays("ultraino_flat8x8");
    let cases = [
        ("sonicsurface", pair, 32.0, delays("sonicsurface_pair")),
        ("mega64", Array::new(flat.positions().to_vec(), None).expect("an array"), 10.0, flat_delays.clone()),
        ("mega64", wired.expect("pins"), 10.0, pins.iter().map(|&pin| flat_delays[pin]).collect()),
    ];
    for (kind, array, steps, delays) in cases {
        let board = array.board_on(kind, (0..array.len()).map(|i| array.pins().map_or(i, |pins| pins[i])).collect());
        let board = if array.pins().is_some() { board } else { array.board(kind) }.expect(kind);
        let drive: Vec<_> = delays.iter().map(|_| Complex32::from_polar(1.0, TAU * rng.uniform() as f32)).collect();
        let (mut frame, mut codes) = (vec![0; board.frame_size()], drive.clone());
        board.encode(&drive, &mut frame).expect("a frame");
        // Without corrections, a board's codes are what its bytes play before the delays of the firmware.
        board.clone().correcting(false).decode(&frame, &mut codes).expect("the frame");
        for (i, (&code, &wanted)) in codes.iter().zip(&drive).enumerate() {
            let delay = Complex32::new(delays[i].re as f32, delays[i].im as f32);
            let off = (code * delay / wanted).arg().abs();
            assert!(off < TAU / (2.0 * steps) + 1e-4, "{kind}: transducer {i} is {off} rad off");
        }
        let mut played = drive.clone();
        board.decode(&frame, &mut played).expect("the frame");
        assert!((played[3] / codes[3] - Complex32::new(delays[3].re as f32, delays[3].im as f32)).norm() < 1e-5);
    }
}
