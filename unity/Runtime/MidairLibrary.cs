// The C library: the functions of midair.h that the scripts call, handles that free themselves, and errors as exceptions.
using System;
using System.Runtime.InteropServices;
using System.Text;
using Microsoft.Win32.SafeHandles;
using UnityEngine;

namespace Midair
{
    /// <summary>The error of a rejected call: a line that names the item, its value and the cure.</summary>
    public class MidairException : Exception
    {
        public MidairException(string line, string code = "invalid") : base(line) { Code = code; }

        /// <summary>One of docs/errors.md, such as "too-near".</summary>
        public string Code { get; }
    }

    /// <summary>midair_metrics: the quality of a drive.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Metrics
    {
        public double accuracy, sigma, uniformity, level, residual, leak;
    }

    /// <summary>midair_answer: how a solve ended; status 0 is done.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Answer
    {
        public int status;
        public UIntPtr steps;
        public double scale;
        public Metrics metrics;
    }

    /// <summary>midair_link: how bytes are sent to a board; kind 0 is a serial line.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Link
    {
        public int kind;
        public UIntPtr lines;
        public uint baud;
        public double rate;
        public int swap, restarts, oneChip, modulates, holdsSequence;
    }

    public sealed class ArrayHandle : SafeHandleZeroOrMinusOneIsInvalid
    {
        ArrayHandle() : base(true) { }

        protected override bool ReleaseHandle()
        {
            Library.midair_array_free(handle);
            return true;
        }
    }

    public sealed class SessionHandle : SafeHandleZeroOrMinusOneIsInvalid
    {
        SessionHandle() : base(true) { }

        protected override bool ReleaseHandle()
        {
            Library.midair_session_free(handle);
            return true;
        }
    }

    public sealed class BoardHandle : SafeHandleZeroOrMinusOneIsInvalid
    {
        BoardHandle() : base(true) { }

        protected override bool ReleaseHandle()
        {
            Library.midair_board_free(handle);
            return true;
        }
    }

    /// <summary>The functions of midair.h. Points are arrays of x, y, z; drives and pressures are arrays of re, im.</summary>
    static class Library
    {
        const string Name = "midair";
        const uint Abi = 1;

        /// <summary>The library's message about the last call. All scripts call the library from Unity's main thread.</summary>
        internal static readonly byte[] Line = new byte[1024];
        internal static readonly UIntPtr Size = (UIntPtr)1024;

        [DllImport(Name)] static extern uint midair_abi();
        [DllImport(Name)] static extern IntPtr midair_last_code();
        [DllImport(Name)] internal static extern int midair_array_board(string kind, out ArrayHandle array, byte[] line, UIntPtr size);
        [DllImport(Name)] internal static extern int midair_array_preset(string name, UIntPtr tilesX, UIntPtr tilesY, out ArrayHandle array, byte[] line, UIntPtr size);
        [DllImport(Name)] internal static extern UIntPtr midair_array_count(ArrayHandle array);
        [DllImport(Name)] internal static extern int midair_array_positions(ArrayHandle array, [Out] double[] positions, [Out] double[] normals, UIntPtr count, byte[] line, UIntPtr size);
        [DllImport(Name)] internal static extern void midair_array_free(IntPtr array);
        [DllImport(Name)] internal static extern int midair_session_new(ArrayHandle array, string method, out SessionHandle session, byte[] line, UIntPtr size);
        [DllImport(Name)] internal static extern int midair_session_set_number(SessionHandle session, string name, double value, byte[] line, UIntPtr size);
        [DllImport(Name)] internal static extern int midair_session_solve(SessionHandle session, double[] points, double[] pressures, double[] weights, UIntPtr count, [Out] float[] drive, UIntPtr transducers, out Answer answer, byte[] line, UIntPtr size);
        [DllImport(Name)] internal static extern int midair_session_field(SessionHandle session, float[] drive, UIntPtr transducers, double[] points, UIntPtr count, [Out] float[] pressures, byte[] line, UIntPtr size);
        [DllImport(Name)] internal static extern void midair_session_free(IntPtr session);
        [DllImport(Name)] internal static extern int midair_board_of_session(string name, SessionHandle session, out BoardHandle board, byte[] line, UIntPtr size);
        [DllImport(Name)] internal static extern UIntPtr midair_board_frame_size(BoardHandle board);
        [DllImport(Name)] internal static extern int midair_board_encode(BoardHandle board, float[] drive, UIntPtr transducers, [Out] byte[] frame, UIntPtr frameSize, byte[] line, UIntPtr size);
        [DllImport(Name)] internal static extern UIntPtr midair_board_silence_size(BoardHandle board);
        [DllImport(Name)] internal static extern int midair_board_silence(BoardHandle board, [Out] byte[] bytes, UIntPtr bytesSize, byte[] line, UIntPtr size);
        [DllImport(Name)] internal static extern int midair_board_link(BoardHandle board, out Link link, byte[] line, UIntPtr size);
        [DllImport(Name)] internal static extern void midair_board_free(IntPtr board);

        /// <summary>Throws the message of a rejected call, and logs warnings.</summary>
        internal static void Check(int result)
        {
            string line = Encoding.UTF8.GetString(Line, 0, Math.Max(Array.IndexOf(Line, (byte)0), 0));
            if (result != 0) throw new MidairException(line, Marshal.PtrToStringAnsi(midair_last_code()));
            foreach (string warning in line.Split(new[] { '\n' }, StringSplitOptions.RemoveEmptyEntries)) Debug.LogWarning(warning);
        }

        /// <summary>Throws if the library is missing or has another interface version.</summary>
        internal static void Require()
        {
            try
            {
                if (midair_abi() != Abi) throw new MidairException($"the library has interface {midair_abi()}: this package needs {Abi}, run `make unity` again");
            }
            catch (DllNotFoundException)
            {
                throw new MidairException("the library midair is missing from Runtime/Plugins: run `make unity` in midair's repository");
            }
        }
    }

    /// <summary>Runs an action that Unity repeats in each frame, and logs the same error only once, as one line.</summary>
    sealed class Repeated
    {
        string last;

        internal void Run(UnityEngine.Object source, Action act)
        {
            try
            {
                act();
                last = null;
            }
            catch (MidairException refused)
            {
                if (refused.Message != last) Debug.LogError(last = refused.Message, source);
            }
        }
    }
}
