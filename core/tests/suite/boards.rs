//! Tests of boards: codes to bytes and back, rounding, switching off, errors, and golden bytes, which other languages test too.
//!
//! `make golden` writes `golden/boards/` again. That is a breaking change, because existing boards read these bytes.

use std::f32::consts::TAU;

use midair::{Board, Code, Complex32, Link, Origin, Rng, presets};

/// Every kind of board, alone and several together.
const BOARDS: [(&str, usize); 11] = [
    ("autd3", 249),
    ("autd3", 2 * 249),
    ("sonicsurface", 256),
    ("sonicsurface", 512),
    ("openmpd", 256),
    ("openmpd", 512),
    ("mega64", 64),
    ("mega64", 150),
    ("nano16", 16),
    ("nano", 8),
    ("homies", 256),
];

fn board(name: &str, transducers: usize) -> Board {
    Board::new(name, transducers).expect(name)
}

fn frame(board: &Board, drive: &[Complex32]) -> Vec<u8> {
    let mut frame = vec![0xcc; board.frame_size()];
    board.encode(drive, &mut frame).expect("a frame");
    frame
}

fn played(board: &Board, frame: &[u8]) -> Vec<Complex32> {
    let mut drive = vec![Complex32::new(9.0, 9.0); board.len()];
    board.decode(frame, &mut drive).expect("a drive");
    drive
}

fn codes(board: &Board, drive: &[Complex32]) -> Vec<Code> {
    let mut codes = vec![Code::default(); board.channel_count()];
    board.codes(drive, &mut codes).expect("codes");
    codes
}

fn random(rng: &mut Rng, count: usize) -> Vec<Complex32> {
    let mut uniform = || (rng.next_u64() >> 40) as f32 / (1 << 24) as f32;
    (0..count).map(|_| Complex32::from_polar(uniform(), TAU * uniform())).collect()
}

#[test]
fn what_a_frame_plays_makes_the_same_frame() {
    let mut rng = Rng::new(1);
    for (name, transducers) in BOARDS {
        let board = board(name, transducers);
        for _ in 0..20 {
            let drive = random(&mut rng, transducers);
            let sent = frame(&board, &drive);
            let received = played(&board, &sent);
            assert_eq!(frame(&board, &received), sent, "{name}");
            // The board homies replaces two phase values by their neighbours.
            assert!(name == "homies" || codes(&board, &received) == codes(&board, &drive), "{name}");
            for (requested, got) in drive.iter().zip(&received).filter(|(_, got)| got.norm() > 0.0) {
                let phases = board.quantization().expect("a grid").phases().expect("phases") as f32;
                let turned = (requested * got.conj()).arg().abs();
                // homies replaces two phase values by their neighbours; a mega64's short pulses have other amplitudes and
                // phases.
                let steps = if name == "homies" {
                    1.5
                } else if name == "mega64" {
                    1.3
                } else {
                    0.5
                };
                assert!(turned < TAU / phases * steps + 1e-5, "{name}: {requested} became {got}");
            }
        }
    }
}

#[test]
fn drives_on_a_boards_grid_come_back() {
    let mut rng = Rng::new(2);
    for (name, transducers) in BOARDS {
        let board = board(name, transducers);
        let grid = board.quantization().expect("a grid");
        let drive: Vec<_> = random(&mut rng, transducers).into_iter().map(|q| grid.nearest(q)).collect();
        for (requested, got) in drive.iter().zip(played(&board, &frame(&board, &drive))) {
            // The board homies replaces two phase values by their neighbours.
            let spared = name == "homies" && requested.norm() > 0.0 && (requested - got).norm() < 0.03;
            assert!((requested - got).norm() < 1e-6 || spared, "{name}: {requested} became {got}");
        }
    }
}

#[test]
fn phases_beside_a_whole_turn_are_phases() {
    let nothing = [0.0, -0.0, -1e-17, 1e-17, f32::MIN_POSITIVE, -f32::MIN_POSITIVE];
    for (name, transducers) in BOARDS {
        let board = board(name, transducers);
        let first = frame(&board, &vec![Complex32::ONE; transducers]);
        for im in nothing {
            assert_eq!(frame(&board, &vec![Complex32::new(1.0, im); transducers]), first, "{name}: {im}");
        }
    }
}

#[test]
fn a_correction_is_taken_from_the_phase_before_it_is_rounded() {
    for (name, transducers) in BOARDS {
        let polarity: Vec<f64> = (0..transducers).map(|i| [0.0, 9.3, -3.0][i % 3]).collect();
        let board = board(name, transducers);
        let corrected = board.clone().with_corrections(&polarity).expect("corrections");
        let drive = vec![Complex32::from_polar(1.0, 0.7); transducers];
        let turned: Vec<_> =
            drive.iter().zip(&polarity).map(|(q, phase)| q * Complex32::from_polar(1.0, -*phase as f32)).collect();
        assert_eq!(frame(&corrected, &drive), frame(&board, &turned), "{name}");
        let [received, requested] =
            [played(&corrected, &frame(&corrected, &drive)), played(&board, &frame(&board, &turned))];
        for ((received, requested), phase) in received.into_iter().zip(requested).zip(&polarity) {
            assert!((received - requested * Complex32::from_polar(1.0, *phase as f32)).norm() < 1e-5, "{name}");
        }
    }
}

#[test]
fn what_is_dead_or_driven_by_nothing_is_off() {
    for (name, transducers) in BOARDS {
        let board = board(name, transducers);
        let nothing = vec![Complex32::ZERO; transducers];
        assert_eq!(frame(&board, &nothing), board.off_frame(), "{name}");
        assert!(played(&board, &board.off_frame()).iter().all(|q| q.norm() == 0.0), "{name}");
        // The bytes that silence one SonicSurface also silence a second board, if there is one.
        assert!(board.silence().ends_with(&board.off_frame()[1..]), "{name}");
        let one = (0..transducers).map(|i| if i == 5 { Complex32::I } else { Complex32::ZERO }).collect::<Vec<_>>();
        assert_eq!(played(&board, &frame(&board, &one)).iter().filter(|q| q.norm() > 0.0).count(), 1, "{name}");
        let live: Vec<bool> = (0..transducers).map(|i| i % 3 > 0).collect();
        let board = board.with_live(live.clone()).expect("live");
        for (q, live) in played(&board, &frame(&board, &vec![Complex32::I; transducers])).into_iter().zip(live) {
            assert_eq!(q.norm() > 0.0, live, "{name}");
        }
    }
}

#[test]
fn broken_frames_are_refused_or_play_something_finite() {
    let mut rng = Rng::new(3);
    for (name, transducers) in BOARDS {
        let board = board(name, transducers);
        let whole = frame(&board, &random(&mut rng, transducers));
        let mut drive = vec![Complex32::ZERO; transducers];
        for at in 0..whole.len() {
            let mut broken = whole.clone();
            broken[at] ^= 1 << (rng.next_u64() % 8);
            if board.decode(&broken, &mut drive).is_ok() {
                assert!(drive.iter().all(|q| q.norm() <= 1.0 + 1e-6), "{name}");
            }
        }
        for wrong in [&whole[..whole.len() - 1], &[&whole[..], &[0]].concat(), &[]] {
            let reported = board.decode(wrong, &mut drive).expect_err("not one frame").to_string();
            assert!(reported.starts_with("frame") && reported.lines().count() == 1, "{name}: {reported}");
        }
    }
}

#[test]
fn what_no_board_can_play_is_refused() {
    let of =
        |name, transducers| Board::new(name, transducers).map(|board| board.len()).expect_err("refused").to_string();
    assert!(of("sonicsurfac", 256).contains("did you mean sonicsurface?"));
    assert_eq!(of("nano", 9), "transducers is 9: nano has 1 to 8 channels");
    assert_eq!(of("nano", 0), "transducers is 0: nano has 1 to 8 channels");
    let nano = board("nano", 8);
    for (drive, reported) in [
        (Complex32::new(f32::NAN, 0.0), "drive[3] is NaN + 0j: give finite drives of at most 1"),
        (Complex32::new(0.0, f32::INFINITY), "drive[3] is 0 + infj: give finite drives of at most 1"),
        (Complex32::new(0.9, 0.9), "drive[3] is 0.9 + 0.9j: give finite drives of at most 1"),
    ] {
        let mut drives = [Complex32::ONE; 8];
        drives[3] = drive;
        assert_eq!(nano.encode(&drives, &mut [0; 49]).expect_err("refused").to_string(), reported);
    }
    let short = nano.encode(&[Complex32::ONE; 8], &mut [0; 48]).expect_err("no room").to_string();
    assert_eq!(short, "frame is 48 bytes: give room for 49");
    let channels = |channels: Vec<usize>| nano.clone().with_channels(channels).err().expect("refused").to_string();
    assert_eq!(channels(vec![0; 8]), "channels[1] is 0: channels[0] is the same: give each once");
    assert_eq!(channels((1..9).collect()), "channels[7] is 8: give channels of 0 to 7");
}

#[test]
fn every_preset_of_a_board_has_its_grid_and_its_order() {
    for preset in presets::PRESETS.iter().filter(|preset| preset.board.is_some()) {
        let board = board(preset.board.unwrap_or_default(), preset.count);
        let array = midair::Array::preset(preset.name, [1, 1]).expect(preset.name);
        assert_eq!(array.quantization(), board.quantization().ok().as_ref(), "{}", preset.name);
        assert_eq!(array.len(), board.len());
        let mut channels = board.channels().to_vec();
        channels.sort_unstable();
        channels.dedup();
        assert_eq!(channels.len(), array.len(), "{}", preset.name);
    }
}

#[test]
fn every_kind_has_an_array_of_its_own_and_a_link() {
    let mut origins = Vec::new();
    for name in Board::names() {
        let array = midair::Array::of_board(name, [1, 1]).expect(name);
        let board = board(name, array.len());
        assert_eq!(array.quantization(), board.quantization().ok().as_ref(), "{name}");
        assert_eq!(array.len(), board.channel_count(), "{name}");
        assert_eq!(board.baud().is_some(), matches!(board.link(), Link::Serial { .. }), "{name}");
        assert!(board.link().modulates() || !board.link().holds_sequence(), "{name}");
        assert_eq!(board.lines(), if board.link().name() == "fifo" { board.boards() } else { 1 }, "{name}");
        origins.push((name, array.origin().clone()));
    }
    let grid = |nx, ny, pitch| Origin::Grid { nx, ny, pitch };
    let preset = |name| Origin::Preset { name, tiles: [1, 1] };
    assert_eq!(
        origins,
        [
            ("autd3", preset("autd3")),
            ("sonicsurface", preset("sonicsurface")),
            ("openmpd", preset("openmpd_board")),
            ("mega64", preset("ultraino_flat8x8")),
            ("nano16", grid(4, 4, 10e-3)),
            ("nano", grid(4, 2, 10e-3)),
            ("homies", grid(16, 16, 10.5e-3)),
        ]
    );
    let refused = midair::Array::of_board("nano", [2, 1]).expect_err("refused").to_string();
    assert_eq!(refused, "array.tiles is [2, 1]: this kind of board is one piece: leave tiles out");
    let tiled = midair::Array::of_board("autd3", [2, 2]).expect("tiled");
    assert_eq!(tiled.len(), 4 * 249);
}

#[cfg(feature = "scene-file")]
mod golden {
    use std::fmt::Write;
    use std::fs;
    use std::path::PathBuf;

    use midair::Rng;
    use serde_json::{Value, json};

    use super::{BOARDS, Complex32, board, frame};

    /// Random drives: amplitude in thousandths, 0 for some of them, and phase in ten-thousandths of a turn.
    fn drive(rng: &mut Rng, count: usize) -> Vec<[u64; 2]> {
        let mut below = |limit: u64| rng.next_u64() % limit;
        (0..count).map(|_| [below(1200).saturating_sub(199), below(10_000)]).collect()
    }

    #[test]
    fn golden_bytes_come_out() {
        let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../golden/boards");
        let mut rng = Rng::new(4);
        for (name, transducers) in BOARDS {
            let path = folder.join(format!("{name}-{transducers}.json"));
            if std::env::var("MIDAIR_GOLDEN").is_ok_and(|wish| wish == "write") {
                let steps = drive(&mut rng, transducers);
                let bytes = frame(&board(name, transducers), &drives(&steps));
                let hex = bytes.iter().fold(String::new(), |mut text, byte| {
                    write!(text, "{byte:02x}").expect("text");
                    text
                });
                let record = json!({
                    "board": name,
                    "drive (amplitude in 1/1000, phase in 1/10000 turn)": steps,
                    "frame": hex,
                });
                fs::create_dir_all(&folder).expect("golden/boards/");
                fs::write(&path, record.to_string() + "\n").expect("a file");
            }
            let record: Value = serde_json::from_str(&fs::read_to_string(&path).expect("make golden")).expect("JSON");
            let steps = &record["drive (amplitude in 1/1000, phase in 1/10000 turn)"];
            let steps: Vec<[u64; 2]> = serde_json::from_value(steps.clone()).expect("a drive");
            let hex = record["frame"].as_str().expect("hex");
            let theirs: Vec<u8> =
                (0..hex.len()).step_by(2).map(|at| u8::from_str_radix(&hex[at..at + 2], 16).expect("hex")).collect();
            assert!(frame(&board(name, transducers), &drives(&steps)) == theirs, "{name} with {transducers}");
        }
    }

    fn drives(steps: &[[u64; 2]]) -> Vec<Complex32> {
        let drive = |&[amplitude, phase]: &[u64; 2]| {
            Complex32::from_polar(amplitude as f32 / 1e3, phase as f32 / 1e4 * super::TAU)
        };
        steps.iter().map(drive).collect()
    }
}
