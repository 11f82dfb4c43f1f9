//! Order: compares the places of an array's transducers with those of a board's channels.
//!
//! Each board of an array may stand anywhere and be turned. On a board of fixed places, a transducer stands where its channel
//! is. Boards that each owner wires have any places; only places of a known array of such a board must be in its order.

use crate::device::board::{self, Board};
use crate::device::format::{Format, Layout};
use crate::prelude::*;
use crate::scene::geometry::middle;
use crate::scene::presets::PRESETS;
use crate::scene::{Array, Pose, distance};

/// The largest distance in m of a transducer from its place on a board.
const NEAR: f64 = 3e-3;
/// The largest distance in m of a transducer from its place in the array that a drive was solved for: 21 degrees of phase at 40 kHz.
const SAME: f64 = 0.5e-3;
/// The smallest cosine of the angle between a transducer's normal and that of its place: 8 degrees.
const FACING: f64 = 0.99;
/// A tip stands this far in m before each place. Tips decide between poses that places alone leave open, and weigh little.
const TIP: f64 = 1e-4;
/// An error shows at most this many numbers of an order.
const SHOWN: usize = 16;

/// Places and unit normals.
struct Sites {
    places: Vec<[f64; 3]>,
    normals: Vec<[f64; 3]>,
}

impl Sites {
    /// Returns the sites of these indices.
    fn of(places: &[[f64; 3]], normals: &[[f64; 3]], indices: &[usize]) -> Self {
        let pick = |list: &[[f64; 3]]| indices.iter().map(|&i| list[i]).collect();
        Self { places: pick(places), normals: pick(normals) }
    }

    /// The places, followed by their tips.
    fn tipped(&self) -> Vec<[f64; 3]> {
        let tips = self.places.iter().zip(&self.normals).map(|(&place, &normal)| *(TIP * Vec3(normal) + place));
        self.places.iter().copied().chain(tips).collect()
    }

    /// Returns in what these sites differ from others that may be moved and turned, by more than `most` m: the index of a site,
    /// and a text.
    fn misfit(&self, others: &Self, most: f64) -> Option<(usize, String)> {
        let pose = Pose::between(&others.tipped(), &self.tipped());
        let there = pose.places(&others.places);
        let apart = |&k: &usize| distance(self.places[k], there[k]);
        let far = (0..there.len()).max_by(|a, b| apart(a).total_cmp(&apart(b)))?;
        // Places that are not finite fit nowhere.
        if apart(&far).is_nan() || apart(&far) > most {
            return Some((far, format!("{:.3} mm from its place", 1e3 * apart(&far))));
        }
        let facing = |&k: &usize| Vec3(self.normals[k]).dot(pose.direction(others.normals[k]));
        let turned = (0..there.len()).find(|k| facing(k) < FACING)?;
        Some((turned, "where it belongs, but faces another way".into()))
    }

    /// Returns the index of the site at the place of each other site, if these sites are the others in any order, moved and
    /// turned. Of several such orders, it is that of the smallest turn.
    fn order(&self, others: &Self) -> Option<Vec<usize>> {
        let count = self.places.len();
        if others.places.len() != count {
            return None;
        }
        let [here, there] = [middle(&self.places), middle(&others.places)];
        let far = |size: &dyn Fn(usize) -> f64| (0..count).max_by(|&a, &b| size(a).total_cmp(&size(b)));
        let arm = |k: usize| Vec3(others.places[k]) - there;
        // Two sites, far from the middle and from the line through it, fix the pose.
        let first = far(&|k| arm(k).norm())?;
        let second = far(&|k| arm(k).cross(arm(first)).norm())?;
        let corners = [there, others.places[first], others.places[second]];
        let alike = |a: f64, b: f64| (a - b).abs() < 2.0 * NEAR;
        let at = |far: f64| (0..count).filter(move |&k| alike(distance(self.places[k], here), far));
        let pairs = at(arm(first).norm()).flat_map(|i| at(arm(second).norm()).map(move |j| [i, j]));
        let apart = distance(corners[1], corners[2]);
        let mut best: Option<(f64, Vec<usize>)> = None;
        for [i, j] in pairs.filter(|&[i, j]| alike(distance(self.places[i], self.places[j]), apart)) {
            let pose = Pose::between(&corners, &[here, self.places[i], self.places[j]]);
            if best.as_ref().is_some_and(|(cosine, _)| *cosine >= pose.cosine()) {
                continue;
            }
            let Some(order) = self.nearest(&pose.places(&others.places)) else { continue };
            if Self::of(&self.places, &self.normals, &order).misfit(others, NEAR).is_none() {
                best = Some((pose.cosine(), order));
            }
        }
        Some(best?.1)
    }

    /// Returns the index of the site nearest to each place, if each site is near to one place. The pose of the places is rough.
    fn nearest(&self, places: &[[f64; 3]]) -> Option<Vec<usize>> {
        let mut free = vec![true; places.len()];
        let near = |&place: &[f64; 3]| {
            let apart = (0..self.places.len()).filter(|&k| free[k]).map(|k| (k, distance(self.places[k], place)));
            let (k, _) = apart.filter(|&(_, apart)| apart < 2.0 * NEAR).min_by(|a, b| a.1.total_cmp(&b.1))?;
            free[k] = false;
            Some(k)
        };
        places.iter().map(near).collect()
    }
}

/// The known arrays of a kind of board: for each, the sites of its channels in order.
fn known(format: &Format) -> Result<Vec<Sites>> {
    let arrays = match format.layout {
        Layout::Grid(..) => vec![Array::of_board(format.name, [1, 1])?],
        Layout::Preset(_) | Layout::Example(_) => {
            let of_kind = PRESETS.iter().filter(|preset| preset.board == Some(format.name));
            let single = of_kind.filter(|preset| preset.count == format.channels);
            single.map(|preset| Array::preset(preset.name, [1, 1])).collect::<Result<_>>()?
        }
    };
    let sites = |array: &Array| {
        let mut order = vec![0; array.len()];
        (0..array.len()).for_each(|i| order[format.channel(i)] = i);
        Sites::of(array.positions(), array.normals(), &order)
    };
    Ok(arrays.iter().map(sites).collect())
}

/// Whether an array consists of two and more boards of a kind of fixed places, to 0.5 mm, board after board.
pub(super) fn is_of_boards(array: &Array) -> bool {
    Board::names().any(|kind| {
        let Ok(format) = board::format(kind) else { return false };
        let (size, fixed) = (format.channels, matches!(format.layout, Layout::Preset(_)));
        if !fixed || array.len() == size || !array.len().is_multiple_of(size) {
            return false;
        }
        let order: Vec<_> = (0..size).map(|i| format.channel(i)).collect();
        let theirs = known(format).unwrap_or_default();
        let is_board = |members: &Vec<usize>| {
            let mine = Sites::of(array.positions(), array.normals(), members);
            let fits = |one: &Sites| mine.misfit(&Sites::of(&one.places, &one.normals, &order), SAME).is_none();
            theirs.iter().any(fits)
        };
        boards(&(0..array.len()).collect::<Vec<_>>(), size).iter().all(is_board)
    })
}

/// The transducers of each board, for boards of `size` channels.
fn boards(channels: &[usize], size: usize) -> Vec<Vec<usize>> {
    let mut members = vec![Vec::new(); channels.iter().max().map_or(0, |most| most / size + 1)];
    channels.iter().enumerate().for_each(|(i, channel)| members[channel / size].push(i));
    members
}

/// The first numbers of a list, as a text.
fn listed(numbers: &[usize]) -> String {
    let shown = numbers.iter().take(SHOWN).map(ToString::to_string).collect::<Vec<_>>().join(", ");
    if numbers.len() > SHOWN { format!("[{shown}, ...]") } else { format!("[{shown}]") }
}

impl Array {
    /// Returns the channel of each transducer (N,) on a kind of board, by its place: the transducer stands where this channel
    /// of a board is, which may stand anywhere. On boards that each owner wires, other places than those of the known arrays
    /// have the channels 0 to N - 1.
    ///
    /// # Errors
    /// An unknown kind, too many transducers or part of a board, other places or normals than those of the board.
    ///
    /// ```
    /// use midair::Array;
    ///
    /// let places = Array::grid(4, 2, 10e-3)?.positions().iter().map(|&[x, y, z]| [-x, y, z]).collect();
    /// let backwards = Array::new(places, None)?;
    /// assert!(backwards.board("nano").is_err_and(|error| error.to_string().contains("another order than nano")));
    /// assert_eq!(backwards.channels_by_place("nano")?, [3, 2, 1, 0, 7, 6, 5, 4]);
    /// # Ok::<(), midair::Error>(())
    /// ```
    pub fn channels_by_place(&self, kind: &str) -> Result<Vec<usize>> {
        let format = board::format(kind)?;
        Board::new(kind, self.len())?;
        self.by_place(format, &(0..self.len()).map(|i| format.channel(i)).collect::<Vec<_>>())
    }

    /// Checks that each transducer i stands where `channels[i]` of a kind of board is.
    ///
    /// # Errors
    /// Another order, and the errors of [`Array::channels_by_place`].
    pub(super) fn check_order(&self, format: &Format, channels: &[usize]) -> Result<()> {
        let placed = self.by_place(format, channels)?;
        if placed == channels {
            return Ok(());
        }
        let order: Vec<_> = channels
            .iter()
            .take(SHOWN + 1)
            .filter_map(|channel| placed.iter().position(|own| own == channel))
            .collect();
        let (order, placed) = (listed(&order), listed(&placed));
        let cure = format!(
            "give its transducers in the order {order}, or pins={placed} (channels= of a Board): see Array.channels_by_place"
        );
        Err(Error::conflict("array", format!("in another order than {}", format.name), cure))
    }

    /// Checks that a drive of another array may be played on this one: its transducers stand in the same order at the same
    /// places, moved and turned as a whole.
    ///
    /// # Errors
    /// Another number of transducers, a transducer more than 0.5 mm from its place.
    pub fn check_drive_of(&self, other: &Self) -> Result<()> {
        let sites = |array: &Self| {
            let (places, normals) = (array.positions().to_vec(), array.normals().to_vec());
            Sites { places, normals }
        };
        let value = if self.len() != other.len() {
            format!("solved for {} transducers, the board has {}", other.len(), self.len())
        } else if self.positions() == other.positions() && self.normals() == other.normals() {
            return Ok(());
        } else if let Some((i, misfit)) = sites(other).misfit(&sites(self), SAME) {
            format!("solved for an array whose transducer {i} stands {misfit} on the board")
        } else {
            return Ok(());
        };
        let cure = "solve for the array of the board";
        Err(Error::of(Notice::new(ErrorCode::Conflict, "the drive", value, cure).verb("was")))
    }

    /// Exchanges the channels of transducers that stand at each other's places.
    fn by_place(&self, format: &Format, channels: &[usize]) -> Result<Vec<usize>> {
        let (known, fixed) = (known(format)?, matches!(format.layout, Layout::Preset(_)));
        let (size, kind) = (known.iter().map(|sites| sites.places.len()).max().unwrap_or(1), format.name);
        if fixed && !channels.len().is_multiple_of(size) && self.pins().is_none() {
            let cure = format!("each {kind} has {size}: give whole boards, with a mask= for what is off");
            let notice = Notice::new(ErrorCode::Shape, "array", format!("{} transducers", channels.len()), cure);
            return Err(Error::of(notice.verb("has")));
        }
        let mut placed = channels.to_vec();
        for members in boards(channels, size).iter().filter(|members| !members.is_empty()) {
            let mine = Sites::of(self.positions(), self.normals(), members);
            let on_board: Vec<_> = members.iter().map(|&i| channels[i] % size).collect();
            let theirs: Vec<_> = known.iter().map(|each| Sites::of(&each.places, &each.normals, &on_board)).collect();
            let misfits: Vec<_> = theirs.iter().map_while(|each| mine.misfit(each, NEAR)).collect();
            if misfits.len() < theirs.len() {
                continue;
            }
            if let Some(order) = theirs.iter().find_map(|each| mine.order(each)) {
                order.iter().zip(members).for_each(|(&k, &i)| placed[members[k]] = channels[i]);
            } else if let (true, Some((k, misfit))) = (fixed, misfits.first()) {
                let cure =
                    format!("give the places and order of {kind}, to {} mm, or channels= of a Board", 1e3 * NEAR);
                return Err(Error::invalid(format!("array.positions[{}]", members[*k]), misfit, cure));
            }
        }
        Ok(placed)
    }
}
