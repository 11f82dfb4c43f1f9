//! Computes the firmware's frames on a PC, to compare both: prints the bits of each drive, the bytes of each frame, and the
//! bytes of silence.

use midair::solvers::{Fast, Greedy, Naive, Uniform};
use midair::{Error, Solve};
use midair_firmware::player::{FRAMES, Player, array};

fn play(solver: impl Solve, name: &str, board: &str, points: usize) -> Result<(), Error> {
    let mut player = Player::new(&array(name)?, board, points, solver)?;
    for frame in 0..FRAMES {
        player.turn(frame)?;
        player.solve()?;
        for q in player.drive() {
            println!("drive {:08x}{:08x}", q.re.to_bits(), q.im.to_bits());
        }
        println!("frame {}", shown(player.encode()?));
    }
    println!("frame {}", shown(&player.silence()));
    Ok(())
}

fn shown(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn main() -> Result<(), Error> {
    let words: Vec<String> = std::env::args().collect();
    let [_, method, name, board, points] = &words[..] else {
        return Err(Error::invalid("the command line", words.len(), "give method, array, board and number of points"));
    };
    let points = points.parse().unwrap_or_default();
    match method.as_str() {
        "fast" => play(Fast::default(), name, board, points),
        "greedy" => play(Greedy::default(), name, board, points),
        "uniform" => play(Uniform::default(), name, board, points),
        "naive" => play(Naive::default(), name, board, points),
        other => Err(Error::invalid("method", other, "give fast, greedy, uniform or naive")),
    }
}
