// Gizmo: |p| in a plane of this object, drawn in the scene view.
using System;
using UnityEngine;

namespace Midair
{
    /// <summary>Shows |p| in this object's plane of x and y, around its middle: the louder, the more opaque.</summary>
    public class MidairGizmo : MonoBehaviour
    {
        public MidairSolver solver;
        [Tooltip("Width and height in units of this object")] public float width = 0.1f;
        public float height = 0.1f;
        [Tooltip("Cells along the width; they are square")] public int across = 40;
        public Color loud = new Color(1f, 0.4f, 0.1f, 1f);

        /// <summary>|p| in Pa, row by row from the lowest y, x fastest; empty before the first solve.</summary>
        public float[] Values { get; private set; } = new float[0];

        readonly Repeated drawing = new Repeated();

        /// <summary>Returns the centre of cell k in this object's own axes.</summary>
        public Vector3 Cell(int k) =>
            new Vector3(Side * (k % across - 0.5f * (across - 1)), Side * (k / across - 0.5f * (Up - 1)), 0f);

        float Side => width / across;
        int Up => Math.Max(1, (int)Math.Round(height / Side));

        /// <summary>Computes |p| in all cells.</summary>
        public void Fill()
        {
            if (solver == null) throw new MidairException("solver is empty: give a solver to the gizmo");
            if (across < 1 || across > 500 || !(width > 0f) || !(height > 0f) || height > 10f * width)
                throw new MidairException($"the gizmo has {across} cells in {width} by {height}: give 1 to 500 cells, a width, and a height up to 10 widths");
            int count = solver.Drive == null ? 0 : across * Up;
            var places = new double[3 * count];
            var pressures = new float[2 * count];
            for (int k = 0; k < count; k++) solver.array.Put(transform.TransformPoint(Cell(k)), places, k);
            if (count > 0) solver.Field(places, pressures);
            Values = new float[count];
            for (int k = 0; k < count; k++)
                Values[k] = (float)Math.Sqrt((double)pressures[2 * k] * pressures[2 * k] + (double)pressures[2 * k + 1] * pressures[2 * k + 1]);
        }

        void OnDrawGizmos() => drawing.Run(this, () =>
        {
            Fill();
            float top = 1e-9f;
            foreach (float value in Values) top = Math.Max(top, value);
            Gizmos.matrix = transform.localToWorldMatrix;
            for (int k = 0; k < Values.Length; k++)
            {
                Gizmos.color = new Color(loud.r, loud.g, loud.b, loud.a * Values[k] / top);
                Gizmos.DrawCube(Cell(k), new Vector3(Side, Side, 0f));
            }
        });
    }
}
