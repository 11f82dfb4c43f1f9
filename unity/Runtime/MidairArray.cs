// Array: the transducers of a board, at the position and rotation of this object.
using System;
using UnityEngine;

namespace Midair
{
    /// <summary>
    /// An array in this object's plane of x and z, which radiates along y. One unit of this object is a metre.
    /// </summary>
    /// <remarks>
    /// midair's axes are right-handed, with z away from the array; Unity's are left-handed, with y up. Exchanging y and z
    /// converts one into the other.
    /// </remarks>
    [ExecuteAlways]
    public class MidairArray : MonoBehaviour
    {
        [Tooltip("A kind of board, as `midair boards` lists them")] public string board = "sonicsurface";
        [Tooltip("Boards along x")] public int tilesX = 1;
        [Tooltip("Boards along z")] public int tilesZ = 1;

        ArrayHandle handle;

        /// <summary>The library's array, opened at the first use and after a change.</summary>
        public ArrayHandle Handle
        {
            get
            {
                if (handle == null)
                {
                    Library.Require();
                    Library.Check(tilesX == 1 && tilesZ == 1
                        ? Library.midair_array_board(board, out var made, Library.Line, Library.Size)
                        : Library.midair_array_preset(board, (UIntPtr)Math.Max(tilesX, 0), (UIntPtr)Math.Max(tilesZ, 0), out made, Library.Line, Library.Size));
                    handle = made;
                }
                return handle;
            }
        }

        /// <summary>Number of transducers.</summary>
        public int Count => (int)Library.midair_array_count(Handle);

        /// <summary>Writes a position in Unity's world as midair's point k: x, y, z in m.</summary>
        public void Put(Vector3 world, double[] points, int k)
        {
            Vector3 local = transform.InverseTransformPoint(world);
            points[3 * k] = local.x;
            points[3 * k + 1] = local.z;
            points[3 * k + 2] = local.y;
        }

        /// <summary>Returns the position in Unity's world of midair's point k.</summary>
        public Vector3 World(double[] points, int k) =>
            transform.TransformPoint(new Vector3((float)points[3 * k], (float)points[3 * k + 2], (float)points[3 * k + 1]));

        void OnValidate() => OnDisable();

        void OnDisable()
        {
            handle?.Dispose();
            handle = null;
        }

        readonly Repeated drawing = new Repeated();

        void OnDrawGizmosSelected() => drawing.Run(this, () =>
        {
            var positions = new double[3 * Count];
            Library.Check(Library.midair_array_positions(Handle, positions, null, (UIntPtr)Count, Library.Line, Library.Size));
            for (int k = 0; k < Count; k++) Gizmos.DrawWireSphere(World(positions, k), 0.005f);
        });
    }
}
