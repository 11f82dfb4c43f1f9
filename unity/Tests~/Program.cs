// Program: runs the scripts as Unity would, and prints lines of a name and its numbers.
using System;
using System.Collections.Generic;
using System.Globalization;
using System.Linq;
using System.Threading;
using UnityEngine;

namespace Midair
{
    static class Program
    {
        static readonly MidairArray array = new MidairArray();
        static readonly MidairPoints points = new MidairPoints();
        static readonly MidairSolver solver = new MidairSolver { array = array, points = points };
        static readonly MidairGizmo gizmo = new MidairGizmo { solver = solver, across = 6, width = 0.06f, height = 0.05f };

        static void Print<T>(string name, IEnumerable<T> values) =>
            Console.WriteLine(name + " " + string.Join(" ", values.Select(value => Convert.ToDouble(value).ToString("R", CultureInfo.InvariantCulture))));

        static Transform At(float x, float y, float z) => new Transform { position = new Vector3(x, y, z) };

        static void Log()
        {
            foreach (string line in Debug.Lines) Console.WriteLine("log " + line);
            Debug.Lines.Clear();
        }

        /// <summary>Solves two foci above a rotated and scaled array, which then move; computes the field between
        /// them.</summary>
        static void Solve()
        {
            (array.transform.position, array.transform.angle, array.transform.scale) = (new Vector3(0.3f, 0.8f, -0.2f), 90f, 2f);
            points.foci = new[] { At(0.32f, 1.1f, -0.24f), At(0.28f, 1.1f, -0.16f) };
            points.pressures = new[] { 1000f, 800f };
            for (int step = 0; step < 2; step++)
            {
                solver.Send("LateUpdate");
                Print("points", points.Points);
                Print("drive", solver.Drive);
                Print("answer", new[] { solver.Answer.status, solver.Answer.scale, solver.Answer.metrics.accuracy, solver.Answer.metrics.level, solver.Answer.metrics.leak });
                points.foci[0].position.y += 0.02f;
            }
            solver.Send("LateUpdate");
            solver.Drive[0] = 7f;
            solver.Send("LateUpdate");
            Print("unmoved", new[] { solver.Drive[0] });
            points.foci[0].position.y -= 0.02f;
            solver.Send("LateUpdate");
            Print("last", points.Points);

            (gizmo.transform.position, gizmo.transform.angle) = (new Vector3(0.3f, 1.1f, -0.2f), 90f);
            gizmo.Send("OnDrawGizmos");
            Print("values", gizmo.Values);
            Print("alphas", Gizmos.Drawn.Select(cell => cell.alpha));
            Gizmos.Drawn.Clear();
            array.Send("OnDrawGizmosSelected");
            Print("transducers", Gizmos.Drawn.SelectMany(drawn => new[] { drawn.at.x, drawn.at.y, drawn.at.z }));
        }

        /// <summary>Plays a focus at a board's address: half a second of frames, a pause, then the end.</summary>
        static void Play(string board, string address)
        {
            array.board = board;
            points.foci = new[] { At(0f, 0.15f, 0f) };
            var player = new MidairPlayer { solver = solver, address = address };
            for (int frame = 0; frame < 25; frame++)
            {
                solver.Send("LateUpdate");
                player.Send("LateUpdate");
                Thread.Sleep(20);
            }
            Print("drive", solver.Drive);
            Thread.Sleep(1200);
            player.Send("LateUpdate");
            Thread.Sleep(200);
            player.Send("OnDisable");
        }

        /// <summary>Plays a track of a palm, one place in m of Unity's world a line of the input, none for no hand.</summary>
        static void Hand(string address)
        {
            array.board = "autd3";
            array.transform.position = new Vector3(0f, 0.7f, 0f);
            var origin = new Transform { position = new Vector3(0f, 0.2f, 0.3f), angle = 90f };
            var player = new MidairPlayer { solver = solver, address = address, modulation = 200f };
            var hand = new MidairHand { array = array, player = player, origin = origin };
            points.foci = new[] { hand.transform };
            for (string line = Console.ReadLine(); line != null; line = Console.ReadLine())
            {
                var place = line.Split(' ').Where(word => word != "").Select(word => float.Parse(word, CultureInfo.InvariantCulture)).ToArray();
                UnityEngine.XR.Management.XRLoader.Hands.rightHand.palm = place.Length == 0
                    ? (Pose?)null : new Pose { position = origin.InverseTransformPoint(new Vector3(place[0], place[1], place[2])) };
                hand.Send("Update");
                solver.Send("LateUpdate");
                if (player.enabled) player.Send("LateUpdate");
                Thread.Sleep(5);
            }
            player.enabled = false;
        }

        /// <summary>Tries mistakes that users make, each for two frames.</summary>
        static void Refuse()
        {
            points.foci = new[] { At(0f, 0.15f, 0f) };
            Action frames = () =>
            {
                for (int frame = 0; frame < 2; frame++) solver.Send("LateUpdate");
                Log();
            };
            array.board = "sonicsurfaces";
            frames();
            array.board = "sonicsurface";
            solver.method = "uniferm";
            frames();
            solver.method = "uniform";
            points.pressures = new[] { 1f, 2f };
            frames();
            points.pressures = new[] { float.NaN };
            frames();
            points.pressures = new[] { 1e6f };
            frames();
            points.foci = new Transform[1];
            points.pressures = new[] { 1000f };
            frames();
            gizmo.across = 0;
            for (int frame = 0; frame < 2; frame++) gizmo.Send("OnDrawGizmos");
        }

        static void Code()
        {
            try
            {
                Library.Check(Library.midair_array_board("sonicsurfaces", out _, Library.Line, Library.Size));
            }
            catch (MidairException error)
            {
                Console.WriteLine("code " + error.Code);
            }
        }

        static void Main(string[] words)
        {
            if (words[0] == "solve") Solve();
            if (words[0] == "refuse") Refuse();
            if (words[0] == "code") Code();
            if (words[0] == "play") Play(words[1], words[2]);
            if (words[0] == "hand") Hand(words[1]);
            Log();
            array.Send("OnDisable");
            solver.Send("OnDisable");
        }
    }
}
