//! Board: converts drives to the bytes that an array's boards receive, and back.

use crate::device::boards::FORMATS;
use crate::device::channels::Channels;
use crate::device::format::{Code, Format, Link, of_pulse, pulse};
use crate::device::quantization::Quantization;
use crate::error;
use crate::kernels::pulses::Pulses;
use crate::prelude::*;

/// The tolerance for drives above 1 because of rounding to f32.
const SLACK: f64 = 1e-6;

/// The boards that drive an array of N transducers.
///
/// ```
/// use midair::{Board, Complex32};
///
/// let board = Board::new("sonicsurface", 256)?;
/// let mut frame = vec![0; board.frame_size()];
/// let mut drive = vec![Complex32::from_polar(1.0, 0.4); 256];
/// drive[7] = Complex32::ZERO;
/// board.encode(&drive, &mut frame)?;
/// // 0.4 rad of 32 phases is the second, 32 is off; transducer 7 is channel 66.
/// assert_eq!(frame[..3], [254, 2, 2]);
/// assert_eq!(frame[1 + 66], 32);
/// board.decode(&frame, &mut drive)?;
/// assert!((drive[0].arg() - 2.0 * std::f32::consts::TAU / 32.0).abs() < 1e-6);
/// # Ok::<(), midair::Error>(())
/// ```
#[derive(Clone)]
pub struct Board {
    format: &'static Format,
    boards: usize,
    /// The pulses that the board can make; `None` if it makes no pulses.
    pulses: Option<Pulses>,
    /// Which transducers one channel drives; `None` if each transducer has its own channel. The lists below have one entry for
    /// each driven channel.
    wiring: Option<Channels>,
    /// For each channel of the boards, the index of its drive; `None` if the channel is unused.
    driven: Vec<Option<usize>>,
    /// For each drive, its channel.
    channels: Vec<usize>,
    /// For each drive, the phase that its transducers add by themselves, in turns.
    corrections: Vec<f64>,
    live: Vec<bool>,
    /// Whether the bytes correct the whole delays, because the array lacks [`Board::response`].
    whole: bool,
}

impl Board {
    /// Returns as many boards of this kind as `transducers` need, in the order of its preset. [`Board::names`] lists the kinds.
    ///
    /// # Errors
    /// An unknown name, no transducers, or more than the boards have channels.
    pub fn new(name: &str, transducers: usize) -> Result<Self> {
        let format = format(name)?;
        Self::of(format, transducers, transducers.div_ceil(format.channels))?
            .with_channels((0..transducers).map(|i| format.channel(i)).collect())
    }

    /// Returns as many boards of this kind as these channels reach: of N transducers, or of the channels of an array.
    pub(crate) fn on(name: &str, channels: Vec<usize>, wiring: Option<&Channels>) -> Result<Self> {
        let format = format(name)?;
        let boards = channels.iter().max().map_or(0, |most| (most / format.channels + 1).min(format.most_boards));
        let board = Self::of(format, channels.len(), boards)?;
        Self { wiring: wiring.cloned(), ..board }.with_channels(channels)
    }

    /// Returns boards without channels.
    fn of(format: &'static Format, transducers: usize, boards: usize) -> Result<Self> {
        let most = format.channels * format.most_boards;
        if transducers == 0 || transducers > most {
            let cure = format!("{} has 1 to {most} channels", format.name);
            return Err(Error::out_of_range("transducers", transducers, cure));
        }
        Ok(Self {
            format,
            boards,
            pulses: format.steps.pulses(),
            wiring: None,
            driven: Vec::new(),
            channels: Vec::new(),
            corrections: vec![0.0; transducers],
            live: vec![true; transducers],
            whole: false,
        })
    }

    /// Returns as many boards of this kind as the channels of an array need; one channel drives several transducers.
    ///
    /// # Errors
    /// An unknown name, more channels than the boards have.
    pub fn wired(name: &str, channels: &Channels) -> Result<Self> {
        let (format, count) = (format(name)?, channels.count());
        let most = format.channels * format.most_boards;
        if count > most {
            let cure = format!("{} has {most}: wire more transducers together", format.name);
            return Err(Error::shape("array.channels", format!("{count} of them"), cure));
        }
        Ok(Self { wiring: Some(channels.clone()), ..Self::new(name, count)? })
    }

    /// The names of all kinds of boards.
    pub fn names() -> impl Iterator<Item = &'static str> {
        FORMATS.iter().map(|format| format.name)
    }

    /// Returns the boards with another channel for each transducer (N,); the channels of a second board follow those of the
    /// first. For an array with channels, there is one entry for each of these (C,).
    ///
    /// # Errors
    /// Another number of entries, a channel that no board has, a channel given twice.
    pub fn with_channels(mut self, channels: Vec<usize>) -> Result<Self> {
        self.one_a_drive("channels", channels.len())?;
        let count = self.boards * self.format.channels;
        self.driven = vec![None; count];
        for (i, &channel) in channels.iter().enumerate() {
            let fault = |cure| Err(Error::invalid(format!("channels[{i}]"), channel, cure));
            match self.driven.get_mut(channel) {
                None => return fault(format!("give channels of 0 to {}", count - 1)),
                Some(Some(other)) => return fault(format!("channels[{other}] is the same: give each once")),
                Some(free) => *free = Some(i),
            }
        }
        self.channels = channels;
        Ok(self)
    }

    /// Returns the boards with corrections: phases (N,) in rad that each transducer adds by itself because of its polarity or
    /// wiring; (C,) for an array with channels. The phase that is sent is the phase of the drive less the correction, then
    /// rounded.
    ///
    /// # Errors
    /// Another number of entries, one that is not finite.
    pub fn with_corrections(mut self, corrections: &[f64]) -> Result<Self> {
        self.one_a_drive("corrections", corrections.len())?;
        for (i, (entry, &correction)) in self.corrections.iter_mut().zip(corrections).enumerate() {
            let turns = error::real(&format!("corrections[{i}]"), correction, f64::MIN, false)? / TAU;
            *entry = turns - math::floor(turns);
        }
        Ok(self)
    }

    /// Returns the boards with transducers (N,) that are always off where `live` is false. A channel is off if all its
    /// transducers are off.
    ///
    /// # Errors
    /// Another number of entries.
    pub fn with_live(mut self, live: Vec<bool>) -> Result<Self> {
        one_each("live", live.len(), "of them", self.len(), "transducers")?;
        self.live = match &self.wiring {
            None => live,
            Some(wiring) => (0..wiring.count()).map(|channel| wiring.members(channel).any(|i| live[i])).collect(),
        };
        Ok(self)
    }

    /// Returns the boards for drives of an array without [`Board::response`]: the bytes correct the whole delays of the
    /// firmware, to the nearest step. For `false` they correct whole steps, and the drives the rest.
    #[must_use]
    pub fn correcting(mut self, whole: bool) -> Self {
        self.whole = whole;
        self
    }

    /// Checks that a list has one value for each drive.
    fn one_a_drive(&self, item: &str, length: usize) -> Result<()> {
        let owners = if self.wiring.is_some() { "channels of the array" } else { "transducers" };
        one_each(item, length, "of them", self.live.len(), owners)
    }

    /// The response of each transducer (N,) to a drive of 1, `None` if all are 1. It describes the delays of the firmware that
    /// are not a whole number of steps; arrays made from the board's preset have it. Whole steps are corrected in the bytes.
    pub fn response(&self) -> Option<Vec<Complex64>> {
        let response = self.format.response(self.channels.iter().copied())?;
        Some(self.wiring.as_ref().map_or_else(|| response.clone(), |wiring| wiring.spread(&response)))
    }

    /// Bits per second on a serial line; `None` for other links.
    pub fn baud(&self) -> Option<u32> {
        match self.format.link {
            Link::Serial { baud, .. } => Some(baud),
            _ => None,
        }
    }

    /// The most frames per second that the link can transmit; on a serial line, a byte takes ten bits.
    pub fn rate(&self) -> f64 {
        match self.format.link {
            Link::Serial { baud, .. } => f64::from(baud) / (10 * self.frame_size()) as f64,
            Link::Fifo { rate, .. } | Link::Udp { rate } => rate,
        }
    }

    /// Writes the code of each channel for a drive (N,); channels without a transducer are off.
    ///
    /// # Errors
    /// Another number of drives, a drive that is not finite or above 1, two different drives on one channel.
    pub fn codes(&self, drive: &[Complex32], codes: &mut [Code]) -> Result<()> {
        let drive = &*self.drives(drive)?;
        one_each("codes", codes.len(), "of them", self.driven.len(), "channels")?;
        for (channel, code) in codes.iter_mut().enumerate() {
            *code = self.code(drive, channel);
        }
        Ok(())
    }

    /// Writes the frame for a drive (N,), of [`Board::frame_size`] bytes.
    ///
    /// # Errors
    /// Another number of drives, a drive that is not finite or above 1, two different drives on one channel, a frame of another
    /// size.
    pub fn encode(&self, drive: &[Complex32], frame: &mut [u8]) -> Result<()> {
        let drive = &*self.drives(drive)?;
        if frame.len() != self.frame_size() {
            let cure = format!("give room for {}", self.frame_size());
            return Err(Error::shape("frame", format!("{} bytes", frame.len()), cure));
        }
        (self.format.encode)(self.boards, &|channel| self.code(drive, channel), frame);
        Ok(())
    }

    /// Warns of a drive above 0 whose frame switches every channel off. A board never switches |q| > 1/2 off.
    pub fn mutes(&self, drive: &[Complex32], frame: &[u8]) -> Option<Notice> {
        let largest = drive.iter().fold(0.0f32, |most, q| most.max(q.norm_sqr()));
        let cure = "switches all transducers off; multiply the drive, or solve for the board's array";
        (largest > 0.0 && largest <= 0.25 && frame == self.off_frame()).then(|| {
            let value = format!("{:.2}", math::sqrt(f64::from(largest)));
            Notice::new(ErrorCode::Scaled, "the drive", value, format!("{} {cure}", self.format.name))
                .verb("is at most")
        })
    }

    /// Writes the drive (N,) that a frame plays.
    ///
    /// # Errors
    /// A frame that the board would not accept, by its first wrong byte; another number of drives.
    pub fn decode(&self, frame: &[u8], drive: &mut [Complex32]) -> Result<()> {
        one_each("drive", drive.len(), "of them", self.len(), "transducers")?;
        let mut channels = vec![Complex32::ZERO; self.live.len()];
        (self.format.decode)(self.boards, frame, &mut |channel, code| {
            if let Some(k) = self.driven[channel] {
                let late = self.late(k);
                channels[k] = match &self.pulses {
                    Some(pulses) => pulse(pulses, code, late),
                    None => self.format.steps.drive(code, late),
                };
            }
        })?;
        drive.copy_from_slice(&self.wiring.as_ref().map_or(channels.clone(), |wiring| wiring.spread(&channels)));
        Ok(())
    }

    /// The frame that switches all channels off.
    pub fn off_frame(&self) -> Vec<u8> {
        let mut frame = vec![0; self.frame_size()];
        (self.format.encode)(self.boards, &|_| Code::default(), &mut frame);
        frame
    }

    fn code(&self, drive: &[Complex32], channel: usize) -> Code {
        match self.driven[channel] {
            Some(i) if self.live[i] => match &self.pulses {
                Some(pulses) => of_pulse(pulses, drive[i], self.late(i)),
                None => self.format.steps.code(drive[i], self.late(i)),
            },
            _ => Code::default(),
        }
    }

    /// The phase in turns that is subtracted from the drive of channel `k`: the delay that its bytes correct.
    fn late(&self, k: usize) -> f64 {
        let (steps, rest) = (self.format.late)(self.channels[k]);
        let rest = if self.whole { rest } else { 0.0 };
        self.corrections[k] + f64::from(steps) / f64::from(self.format.steps.phases) + rest
    }

    /// Checks a drive (N,), and returns the drive of each driven channel.
    fn drives<'a>(&self, drive: &'a [Complex32]) -> Result<Cow<'a, [Complex32]>> {
        one_each("drive", drive.len(), "of them", self.len(), "transducers")?;
        // The test in f32 is faster; only values close to 1 need double precision.
        let fits = |q: &Complex32| q.norm_sqr() <= 1.0 || (q.is_finite() && math::modulus(*q) <= 1.0 + SLACK);
        if let Some(i) = drive.iter().position(|q| !fits(q)) {
            let value = format!("{} + {}j", drive[i].re, drive[i].im);
            let code = if drive[i].is_finite() { ErrorCode::OutOfRange } else { ErrorCode::NotFinite };
            return Err(Error::new(code, format!("drive[{i}]"), value, "give finite drives of at most 1"));
        }
        self.wiring.as_ref().map_or(Ok(Cow::Borrowed(drive)), |wiring| wiring.drives(drive).map(Cow::Owned))
    }
}

getters! {
    Board:

    /// The name of the kind of board.
    pub name(self) -> &'static str = self.format.name;

    /// The description of the kind of board in one line.
    pub summary(self) -> &'static str = self.format.summary;

    /// The publication or source code that defines the bytes.
    pub source(self) -> &'static str = self.format.source;

    /// The number of transducers N.
    #[allow(clippy::len_without_is_empty, reason = "a board is never empty")]
    pub len(self) -> usize = self.wiring.as_ref().map_or(self.live.len(), |wiring| wiring.of().len());

    /// The number of boards.
    pub boards(self) -> usize = self.boards;

    /// The number of lines: one for all boards, or one for each board. A frame consists of one part for each line, all of the
    /// same length.
    pub lines(self) -> usize = if let Link::Fifo { .. } = self.format.link { self.boards } else { 1 };

    /// The most boards of this kind that can play together.
    pub most_boards(self) -> usize = self.format.most_boards;

    /// The number of channels of all boards.
    pub channel_count(self) -> usize = self.driven.len();

    /// The channel of each transducer (N,), or (C,) for an array with channels.
    pub channels(self) -> &[usize] = &self.channels;

    /// The number of bytes of a frame, for all lines together.
    pub frame_size(self) -> usize = (self.format.size)(self.boards);

    /// The type of link over which the bytes are sent.
    pub link(self) -> Link = self.format.link;

    /// The ultrasound frequency in Hz.
    pub frequency(self) -> f64 = self.format.frequency;

    /// The most frames per second during which the emitted sound is not disturbed, at most [`Board::rate`].
    pub steady_rate(self) -> f64 = self.rate().min(self.format.steady / self.boards as f64);

    /// The phases and amplitudes that the board can play. Drives between them may get other pulse widths.
    ///
    /// # Errors
    /// None, for the boards of [`Board::names`].
    pub quantization(self) -> Result<Quantization> = self.format.steps.quantization();

    /// Returns bytes that switch the boards off from any state. If a board has two banks, both banks are then off.
    pub silence(self) -> Vec<u8> = (self.format.silence)(self.boards, &self.off_frame());
}

/// The description of a kind of board.
pub(crate) fn format(name: &str) -> Result<&'static Format> {
    error::find("board", name, &FORMATS, |format| format.name)
}
