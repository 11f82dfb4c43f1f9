//! Player: points that go round in a circle, solved frame by frame and encoded for a board.

use alloc::format;
use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::TAU;

use midair::{
    Array, Board, Complex32, Control, Error, InstructionSet, Model, Problem, Request, Solution, Solve,
    Workspace, solve,
};

/// Radius and height of the circle, in m.
const CIRCLE: [f64; 2] = [0.03, 0.15];

/// Turns of the circle between two frames.
const STEP: f64 = 0.01;

/// Frames that are played where frames are counted or compared.
pub const FRAMES: u16 = 3;

/// An array, its board, and all the memory that frames need.
#[allow(missing_debug_implementations, reason = "a solver need not have one")]
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

/// The array "sonicsurface", "ultraino_flat8x8" or another preset, or a number of transducers of a square grid.
///
/// # Errors
/// A name that is neither.
pub fn array(name: &str) -> Result<Array, Error> {
    match name.parse::<usize>() {
        Ok(count) => {
            let side = count.isqrt();
            Array::grid(side, side, 10e-3)
        }
        Err(_) => Array::preset(name, [1, 1]),
    }
}

// None of these is inlined: their variables on the stack would lie below a solve.
impl<S: Solve> Player<S> {
    /// The player for an array that a kind of board plays, and a number of points.
    ///
    /// # Errors
    /// What array, board or medium cannot be.
    #[inline(never)]
    pub fn new(array: &Array, board: &str, points: usize, solver: S) -> Result<Self, Error> {
        if points == 0 {
            return Err(Error::invalid("points", points, "give at least 1"));
        }
        let board = array.board(board)?;
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

    /// Moves the points to where they are in a frame.
    ///
    /// # Errors
    /// A point on a transducer.
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

    /// Solves them.
    ///
    /// # Errors
    /// What the solver refuses; no points yet.
    #[inline(never)]
    pub fn solve(&mut self) -> Result<(), Error> {
        let problem = self.problem.as_ref().ok_or_else(|| Error::invalid("points", "none yet", "turn them first"))?;
        let balance = !self.solver.finds_level();
        self.solution = Some(solve(problem, &self.solver, balance, &mut self.work, &mut Control::none())?);
        Ok(())
    }

    /// The drives of the frame.
    #[must_use]
    pub fn drive(&self) -> &[Complex32] {
        self.solution.as_ref().map_or(&[], |solution| &solution.drive)
    }

    /// The bytes of the frame.
    ///
    /// # Errors
    /// No drive yet.
    #[inline(never)]
    pub fn encode(&mut self) -> Result<&[u8], Error> {
        let Some(solution) = &self.solution else {
            return Err(Error::invalid("drive", "none yet", format!("solve first, for {} points", self.points.len())));
        };
        self.board.encode(&solution.drive, &mut self.frame)?;
        Ok(&self.frame)
    }

    /// The bytes that silence the board, from any state.
    #[must_use]
    pub fn silence(&self) -> Vec<u8> {
        self.board.silence()
    }
}
