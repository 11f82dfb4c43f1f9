// Fake: the few types of Unity that the scripts use, without an engine. A transform has a position, a rotation and a scale.
using System;
using System.Collections.Generic;
using System.Reflection;

namespace UnityEngine
{
    public class Object { }

    public class MonoBehaviour : Object
    {
        public readonly Transform transform = new Transform();
        bool on = true;

        /// <summary>Like the engine, calls OnDisable when a script is switched off.</summary>
        public bool enabled
        {
            get => on;
            set
            {
                if (on && !value) Send("OnDisable");
                on = value;
            }
        }

        /// <summary>Calls one of Unity's messages by name, public or not, as the engine does.</summary>
        public void Send(string message) =>
            GetType().GetMethod(message, BindingFlags.Instance | BindingFlags.Public | BindingFlags.NonPublic).Invoke(this, null);
    }

    public struct Vector3
    {
        public float x, y, z;
        public Vector3(float x, float y, float z) { this.x = x; this.y = y; this.z = z; }
    }

    public struct Color
    {
        public float r, g, b, a;
        public Color(float r, float g, float b, float a) { this.r = r; this.g = g; this.b = b; this.a = a; }
    }

    public struct Matrix4x4 { }

    public struct Pose { public Vector3 position; }

    /// <summary>position + R (scale p); R rotates about y by the angle in degrees: clockwise from above, as in Unity.</summary>
    public class Transform : Object
    {
        public Vector3 position;
        public float angle, scale = 1f;
        public Matrix4x4 localToWorldMatrix;

        (float cos, float sin) Turn => ((float)Math.Cos(angle * Math.PI / 180), (float)Math.Sin(angle * Math.PI / 180));

        public Vector3 TransformPoint(Vector3 p)
        {
            var (cos, sin) = Turn;
            return new Vector3(position.x + scale * (cos * p.x + sin * p.z), position.y + scale * p.y, position.z + scale * (cos * p.z - sin * p.x));
        }

        public Vector3 InverseTransformPoint(Vector3 p)
        {
            var (cos, sin) = Turn;
            float x = (p.x - position.x) / scale, z = (p.z - position.z) / scale;
            return new Vector3(cos * x - sin * z, (p.y - position.y) / scale, cos * z + sin * x);
        }
    }

    public static class Gizmos
    {
        public static Color color;
        public static Matrix4x4 matrix;
        public static readonly List<(Vector3 at, float alpha)> Drawn = new List<(Vector3, float)>();
        public static void DrawCube(Vector3 at, Vector3 size) => Drawn.Add((at, color.a));
        public static void DrawWireSphere(Vector3 at, float radius) => Drawn.Add((at, radius));
    }

    public static class Debug
    {
        public static readonly List<string> Lines = new List<string>();
        public static void LogError(string line, Object source = null) => Lines.Add("error: " + line);
        public static void LogWarning(string line) => Lines.Add("warning: " + line);
    }

    [AttributeUsage(AttributeTargets.Class)] public class ExecuteAlways : Attribute { }
    [AttributeUsage(AttributeTargets.Class)] public class DefaultExecutionOrder : Attribute { public DefaultExecutionOrder(int order) { } }
    [AttributeUsage(AttributeTargets.Field)] public class TooltipAttribute : Attribute { public TooltipAttribute(string tip) { } }
}

namespace UnityEngine.XR.Hands
{
    public enum XRHandJointID { Palm }

    /// <summary>A joint with the pose that a recorded track gives it, or none.</summary>
    public struct XRHandJoint
    {
        internal Pose? pose;

        public bool TryGetPose(out Pose found)
        {
            found = pose.GetValueOrDefault();
            return pose.HasValue;
        }
    }

    public struct XRHand
    {
        internal Pose? palm;
        public bool isTracked => palm.HasValue;
        public XRHandJoint GetJoint(XRHandJointID joint) => new XRHandJoint { pose = palm };
    }

    public class XRHandSubsystem { public XRHand rightHand; }
}

namespace UnityEngine.XR.Management
{
    using UnityEngine.XR.Hands;

    public class XRLoader
    {
        public static readonly XRHandSubsystem Hands = new XRHandSubsystem();
        public T GetLoadedSubsystem<T>() where T : class => Hands as T;
    }

    public class XRManagerSettings { public XRLoader activeLoader = new XRLoader(); }

    public class XRGeneralSettings
    {
        public static readonly XRGeneralSettings Instance = new XRGeneralSettings();
        public XRManagerSettings Manager = new XRManagerSettings();
    }
}
