// Player: a board plays the solver's points or drive, through `midair serve` or at a serial port.
using System;
using UnityEngine;

namespace Midair
{
    /// <summary>Sends the newest points or drive in each frame; sends silence if there are none, and at the end.</summary>
    [DefaultExecutionOrder(100)]
    public class MidairPlayer : MonoBehaviour
    {
        public MidairSolver solver;
        [Tooltip("The line that `midair serve --on BOARD` prints, osc://127.0.0.1:PORT token TOKEN, or a serial port: /dev/ttyUSB0, COM3")]
        public string address = "osc://127.0.0.1:PORT token TOKEN";
        [Tooltip("Modulation in Hz by midair serve, such as 200 for a focus that a hand feels; 0 for none")] public float modulation;

        ServerLine server;
        SerialLine serial;
        BoardHandle board;
        SessionHandle session;
        readonly Repeated sending = new Repeated();

        void LateUpdate() => sending.Run(this, () =>
        {
            if (solver == null) throw new MidairException("solver is empty: give a solver to the player");
            if (address.StartsWith("osc://"))
            {
                if (server == null)
                {
                    server = new ServerLine(address);
                    if (modulation > 0) server.Say("/midair/modulation", modulation);
                }
                server.Give(solver.Drive == null ? new float[0] : Rows());
            }
            else if (solver.Drive == null) serial?.Give(null);
            else
            {
                if (session != solver.Session) Open();
                serial.Give(Frame());
            }
        });

        float[] Rows()
        {
            var (points, pressures) = (solver.points.Points, solver.points.Pressures);
            var rows = new float[4 * pressures.Length];
            for (int k = 0; k < rows.Length; k++) rows[k] = (float)(k % 4 < 3 ? points[k / 4 * 3 + k % 4] : pressures[k / 4]);
            return rows;
        }

        byte[] Frame()
        {
            var frame = new byte[(int)Library.midair_board_frame_size(board)];
            Library.Check(Library.midair_board_encode(
                board, solver.Drive, (UIntPtr)(solver.Drive.Length / 2), frame, (UIntPtr)frame.Length, Library.Line, Library.Size));
            return frame;
        }

        /// <summary>Opens the port for the solver's array; transducers that are wired together have one channel.</summary>
        void Open()
        {
            OnDisable();
            string kind = solver.array.board;
            Library.Check(Library.midair_board_of_session(kind, solver.Session, out board, Library.Line, Library.Size));
            Library.Check(Library.midair_board_link(board, out var link, Library.Line, Library.Size));
            if (link.kind != 0 || (int)link.lines != 1)
                throw new MidairException($"{kind} is not at one serial port: run `midair serve --on {kind}` and give the line that it prints");
            var off = new byte[(int)Library.midair_board_silence_size(board)];
            Library.Check(Library.midair_board_silence(board, off, (UIntPtr)off.Length, Library.Line, Library.Size));
            (serial, session) = (new SerialLine(address, link, off), solver.Session);
        }

        void OnDisable()
        {
            if (server != null) sending.Run(this, () => server.Give(new float[0]));
            server?.Dispose();
            serial?.Dispose();
            board?.Dispose();
            (server, serial, board, session) = (null, null, null, null);
        }
    }
}
