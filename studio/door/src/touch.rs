//! Touch: the predicted motion of a skin under the frames that `follow` has solved, which repeat for ever.

use midair::touch::Touch;
use midair::{Control, Error, Result};

use crate::studio::Studio;

impl Studio {
    pub(crate) fn skin(&mut self, rate: f64) -> Result<()> {
        let scene = &self.opened()?.scene;
        let (transducers, medium) = (scene.array().len(), scene.medium());
        let places: Vec<[f64; 3]> = self.numbers_in.as_chunks().0.to_vec();
        let count = self.frames.len() / transducers;
        let mut pushed = |frame: usize| {
            self.frame(frame)?;
            self.field()?;
            Ok(self.pressures.iter().map(|p| medium.radiation(f64::from(p.norm())) as f32).collect())
        };
        let touch = Touch::of_frames(count, rate, &places, &mut pushed, &mut Control::none())?;
        self.frame(0)?;
        self.numbers = vec![touch.width(&places), touch.peak(), touch.force()];
        self.numbers.extend(touch.skin.strength().into_iter().chain(touch.pressed.iter().copied()));
        self.touch = Some(touch);
        Ok(())
    }

    pub(crate) fn moved(&mut self, frame: usize) -> Result<()> {
        let touch = self.touch.as_ref().filter(|touch| frame < touch.count());
        let touch = touch.ok_or_else(|| Error::out_of_range("frame", frame, "predict the skin's motion first"))?;
        self.numbers = touch.at(frame, 0..touch.skin.slow.len()).into_iter().map(f64::from).collect();
        Ok(())
    }
}
