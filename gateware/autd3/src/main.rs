//! The makers' emulators of AUTD3 devices: `autd3-emulators 0.12|0.13 COUNT` prints the UDP address of this many
//! devices. Each line of its input is a command: "state" prints the state of every device as a line of JSON, a number
//! reboots that device. The program ends with its input.

use std::io::{self, BufRead, Write};

/// Serves devices of one firmware. It is a macro, because the two crates have the same names but no common type.
macro_rules! serve {
    ($firmware:ident, $count:expr, $reboot:expr) => {{
        let emulator = $firmware::udp::UdpEmulator::spawn($count.parse().map_err(io::Error::other)?)?;
        println!("{}", emulator.addr());
        io::stdout().flush()?;
        for line in io::stdin().lock().lines() {
            if let Ok(device) = line?.parse::<usize>() {
                $reboot(&emulator, device);
                continue;
            }
            let devices = emulator.with_devices(|devices| {
                let states = devices.iter().map(|device| {
                    let fpga = device.fpga();
                    let (bank, modulation) = (fpga.current_pattern_bank(), fpga.current_mod_bank());
                    let code = |slot: usize| {
                        let (phases, intensities) = fpga.emissions_at(bank, slot);
                        let phases = phases.into_iter().map(|phase| phase.0);
                        hex(phases.chain(intensities.into_iter().map(|intensity| intensity.0)))
                    };
                    let slots: Vec<String> = (0..fpga.pattern_cycle(bank)).map(code).collect();
                    format!(
                        "{{\"bank\": {bank}, \"divider\": {}, \"slots\": {slots:?}, \"modulation\": \"{}\", \
                         \"sampling\": {}, \"silencer\": [{}, {}], \"failsafe\": {}}}",
                        fpga.pattern_freq_div(bank),
                        hex(fpga.modulation_buffer(modulation)),
                        fpga.modulation_freq_div(modulation),
                        fpga.silencer_completion_steps_intensity(),
                        fpga.silencer_completion_steps_phase(),
                        fpga.failsafe(),
                    )
                });
                states.collect::<Vec<_>>().join(", ")
            });
            println!("[{devices}]");
            io::stdout().flush()?;
        }
        Ok(())
    }};
}

fn hex(bytes: impl IntoIterator<Item = u8>) -> String {
    bytes.into_iter().map(|byte| format!("{byte:02x}")).collect()
}

fn main() -> io::Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["0.12", count] => serve!(firmware12, count, |all: &firmware12::udp::UdpEmulator, k| all.reboot(k)),
        // This firmware reboots by a command.
        ["0.13", count] => serve!(firmware13, count, |all: &firmware13::udp::UdpEmulator, k| {
            all.with_device(k, |device| device.send(&[0, 7, 0, 0, 0, 0]));
        }),
        _ => Err(io::Error::other("give 0.12 or 0.13, and a number of devices")),
    }
}
