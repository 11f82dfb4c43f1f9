//! Player: points that move on a circle, solved frame by frame and encoded for a board.

use alloc::format;
use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::TAU;

use midair::{
    Array, Board, Complex32, Control, Error, InstructionSet, Model, Problem, Request, Solution, Solve, Workspace, solve,
};

/// Radius and height of the circle, in m.
const CIRCLE: [f64; 2] = [0.03, 0.15];

/// Turns of the circle between two frames.
const STEP: f64 = 0.01;

/// The number of frames that tests and measurements play.
pub const FRAMES: u16 = 3;

/// An array, its board, and all the memory that frames need.
pub struct Player<S> {
    solver: S,
    model: Model,
    board: Board,
    points: Vec<[f64; 3]>,
    request: Request,
    /// None before the first frame and after a rejected one.
    problem: Option<Problem>,
    solution: Option<Solution>,
    work: Workspace,
    frame: Vec<u8>,
}

/// Returns the preset "sonicsurface", "ultraino_flat8x8" or another one, or a square grid if the name is a number of
/// transducers.
///
/// # Errors
///
/// If the name is neither that of a preset nor a number.
pub fn array(name: &str) -> Result<Array, Error> {
    match name.parse::<usize>() {
        Ok(count) => {
            let side = count.isqrt();
            Array::grid(side, side, 10e-3)
        }
        Err(_) => Array::preset(name, [1, 1]),
    }
}

// No function is inlined, because its variables would otherwise stay on the stack during a solve.
impl<S: Solve> Player<S> {
    /// Makes a player for an array, the kind of board that plays it, and a number of points.
    ///
    /// # Errors
    ///
    /// If array, board or medium are not valid.
    #[inline(never)]
    pub fn new(array: &Array, board: &str, points: usize, solver: S) -> Result<Self, Error> {
        if points == 0 {
            return Err(Error::invalid("points", points, "give at least 1"));
        }
        // A square grid is not at the places of a board: its transducers take the board's channels in order.
        let channels = Board::new(board, array.len())?.channels().to_vec();
        let board = array.board_on(board, channels)?;
        Ok(Self {
            solver,
            model: Model::new(array, array.medium(&[])?, InstructionSet::SCALAR)?,
            points: vec![[0.0; 3]; points],
            request: Request::default(),
            problem: None,
            solution: None,
            work: Workspace::new(),
            frame: vec![0; board.frame_size()],
            board,
        })
    }

    /// Moves the points to their places in a frame.
    ///
    /// # Errors
    ///
    /// If a point is on a transducer.
    #[inline(never)]
    pub fn turn(&mut self, frame: u16) -> Result<(), Error> {
        let count = self.points.len() as f64;
        for (k, point) in self.points.iter_mut().enumerate() {
            let angle = TAU * (k as f64 / count + STEP * f64::from(frame));
            *point = [CIRCLE[0] * libm::cos(angle), CIRCLE[0] * libm::sin(angle), CIRCLE[1]];
        }
        if let Some(solution) = self.solution.take() {
            solution.recycle(&self.work);
        }
        self.problem = Some(match self.problem.take() {
            Some(problem) => problem.renewed(Some(&self.points), &self.request)?,
            None => Problem::of_model(&self.model, &self.points, &self.request, &mut Control::none())?,
        });
        Ok(())
    }

    /// Solves the frame.
    ///
    /// # Errors
    ///
    /// If the solver rejects the points, or if there are none yet.
    #[inline(never)]
    pub fn solve(&mut self) -> Result<(), Error> {
        let problem = self.problem.as_ref().ok_or_else(|| Error::invalid("points", "none yet", "turn them first"))?;
        let balance = !self.solver.finds_level();
        self.solution = Some(solve(problem, &self.solver, balance, &mut self.work, &mut Control::none())?);
        Ok(())
    }

    /// Returns the drive of the frame.
    pub fn drive(&self) -> &[Complex32] {
        self.solution.as_ref().map_or(&[], |solution| &solution.drive)
    }

    /// Returns the bytes of the frame.
    ///
    /// # Errors
    ///
    /// If there is no drive yet.
    #[inline(never)]
    pub fn encode(&mut self) -> Result<&[u8], Error> {
        let Some(solution) = &self.solution else {
            return Err(Error::invalid("drive", "none yet", format!("solve first, for {} points", self.points.len())));
        };
        self.board.encode(&solution.drive, &mut self.frame)?;
        Ok(&self.frame)
    }

    /// Returns the bytes that silence the board in any state.
    pub fn silence(&self) -> Vec<u8> {
        self.board.silence()
    }
}
