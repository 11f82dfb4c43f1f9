// Points: the positions of transforms and the pressures requested there.
using System;
using UnityEngine;

namespace Midair
{
    /// <summary>Foci that follow transforms.</summary>
    public class MidairPoints : MonoBehaviour
    {
        public Transform[] foci = new Transform[0];
        [Tooltip("Peak pressures in Pa: one for all foci, or one each; 0 is a quiet point, absent by midair serve")] public float[] pressures = { 1000f };

        /// <summary>midair's points, x, y, z in m of the array, and pressures in Pa, from the last call of Read.</summary>
        public double[] Points { get; private set; } = new double[0];
        public double[] Pressures { get; private set; } = new double[0];

        /// <summary>Reads the transforms in the array's axes, and returns whether anything changed.</summary>
        public bool Read(MidairArray array)
        {
            int count = foci.Length;
            if (pressures.Length != 1 && pressures.Length != count)
                throw new MidairException($"pressures has {pressures.Length} entries: give 1, or {count} as foci has");
            bool changed = Pressures.Length != count;
            if (changed) (Points, Pressures) = (new double[3 * count], new double[count]);
            var place = new double[3];
            for (int k = 0; k < count; k++)
            {
                if (foci[k] == null) throw new MidairException($"foci[{k}] is empty: give a transform");
                array.Put(foci[k].position, place, 0);
                double pressure = pressures[pressures.Length == 1 ? 0 : k];
                changed |= Pressures[k] != pressure;
                Pressures[k] = pressure;
                for (int axis = 0; axis < 3; axis++)
                {
                    changed |= Points[3 * k + axis] != place[axis];
                    Points[3 * k + axis] = place[axis];
                }
            }
            return changed;
        }
    }
}
