//! Measured: runs a few frames under an emulator, and reports their costs and drives by semihosting.

use midair::{Error, Solve};
use semihosting::println;

use crate::board::Uart;
use crate::clock::Clock;
use crate::mute::Mute;
use crate::player::{FRAMES, Player, array};
use crate::{heap, stack};

/// Ticks of the clock without a message before the board is silenced: 5 ms at 25 MHz, because an emulator is slow. A
/// product waits for 250 ms.
const PATIENCE: u32 = 125_000 * Clock::PARTS;

/// Plays frames for the three words of the command line: array, board and number of points. Prints lines of `name
/// value`: ticks of the set-up, of new points, solving and encoding in the last frame; bytes of heap and stack; the
/// allocations after the first frame; and for each frame the bits of its drive. After the last frame the board is
/// silenced.
///
/// # Errors
///
/// If a word is missing or wrong, or a frame cannot be solved.
#[inline(always)]
pub fn run<S: Solve>(solver: S) -> Result<(), Error> {
    heap::begin();
    let missing = |what: &str| Error::invalid(what, "missing", "give array, board and number of points");
    let words = semihosting::experimental::env::args::<128>().map_err(|_| missing("the command line"))?;
    let mut words = (&words).into_iter().filter_map(Result::ok).skip(1);
    let (name, board) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
    let points = words.next().and_then(|word| word.parse().ok()).ok_or_else(|| missing("points"))?;

    let clock = Clock::new(cortex_m::Peripherals::take().ok_or_else(|| missing("the processor"))?.SYST);
    let mut uart = Uart::new(230_400);
    let (setup, player) = clock.ticks(|| Player::new(&array(name)?, board, points, solver));
    let mut player = player?;
    let mut last = [0; 3];
    let mut before = 0;
    for frame in 0..FRAMES {
        let (turned, result) = clock.ticks(|| player.turn(frame));
        result?;
        let (solved, result) = clock.ticks(|| player.solve());
        result?;
        let (encoded, bytes) = clock.ticks(|| player.encode());
        uart.send(bytes?);
        last = [turned, solved, encoded];
        if frame == 0 {
            before = heap::allocations();
        }
        // One line per number, because a text of all of them would need allocated memory.
        for q in player.drive() {
            println!("drive {:08x}{:08x}", q.re.to_bits(), q.im.to_bits());
        }
    }
    let allocations = heap::allocations() - before;
    let mut mute = Mute::new(PATIENCE);
    mute.hear(clock.now());
    while !mute.is_due(clock.now()) {}
    uart.send(&player.silence());
    let [turned, solved, encoded] = last;
    println!("setup {setup}\npoints {turned}\nsolve {solved}\nencode {encoded}");
    println!("heap {}\nstack {}\nallocations {}", heap::most(), stack::most(), allocations);
    Ok(())
}

/// Ends the program with the status of a result.
pub fn end(result: Result<(), Error>) -> ! {
    if let Err(error) = &result {
        println!("error {error}");
    }
    semihosting::process::exit(result.is_err().into())
}
