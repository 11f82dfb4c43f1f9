// Solver: the array's drive for the points, solved again when a point moves.
using System;
using UnityEngine;

namespace Midair
{
    /// <summary>Solves after each frame in which a point, the array or a setting changed.</summary>
    [ExecuteAlways]
    public class MidairSolver : MonoBehaviour
    {
        public MidairArray array;
        public MidairPoints points;
        [Tooltip("A method, as `midair solvers` lists them")] public string method = "uniform";
        [Tooltip("Temperature of the air in °C")] public float temperature = 25f;

        /// <summary>The drive, re and im of each transducer; null before the first solve and after an error.</summary>
        public float[] Drive { get; private set; }

        /// <summary>How the last solve ended, and its metrics.</summary>
        public Answer Answer { get; private set; }

        /// <summary>The library's session, null before the first solve.</summary>
        public SessionHandle Session { get; private set; }

        ArrayHandle opened;
        readonly Repeated frame = new Repeated();

        /// <summary>Writes complex pressures in Pa, re and im of each point, at midair's points, with the answer's scale
        /// applied.</summary>
        public void Field(double[] places, float[] pressures)
        {
            Library.Check(Library.midair_session_field(
                Session, Drive, (UIntPtr)(Drive.Length / 2), places, (UIntPtr)(places.Length / 3), pressures, Library.Line, Library.Size));
            for (int k = 0; k < pressures.Length; k++) pressures[k] *= (float)Answer.scale;
        }

        void LateUpdate() => frame.Run(this, () =>
        {
            if (array == null || points == null) throw new MidairException("array or points is empty: give both to the solver");
            bool anew = Session == null || opened != array.Handle;
            if (anew) Open();
            if (points.Read(array) || anew || Drive == null) Solve();
        });

        void Open()
        {
            OnDisable();
            Library.Check(Library.midair_session_new(array.Handle, method, out var session, Library.Line, Library.Size));
            (Session, opened) = (session, array.Handle);
            Library.Check(Library.midair_session_set_number(Session, "temperature", temperature, Library.Line, Library.Size));
        }

        void Solve()
        {
            var drive = Drive ?? new float[2 * array.Count];
            Drive = null;
            Library.Check(Library.midair_session_solve(
                Session, points.Points, points.Pressures, null, (UIntPtr)points.Pressures.Length,
                drive, (UIntPtr)(drive.Length / 2), out var answer, Library.Line, Library.Size));
            (Drive, Answer) = (drive, answer);
        }

        void OnValidate() => OnDisable();

        void OnDisable()
        {
            Session?.Dispose();
            (Session, opened, Drive) = (null, null, null);
        }
    }
}
