// Hand: this object follows the right palm that OpenXR tracks, and the player plays while the palm is in the button.
using UnityEngine;
using UnityEngine.XR.Hands;
using UnityEngine.XR.Management;

namespace Midair
{
    /// <summary>A button in the air. It needs the packages XR Hands and OpenXR Plugin.</summary>
    public class MidairHand : MonoBehaviour
    {
        public MidairArray array;
        [Tooltip("The player of a solver whose only focus is this object")] public MidairPlayer player;
        [Tooltip("The Camera Offset of the XR Origin: hands are relative to it")] public Transform origin;
        [Tooltip("The button's radius and its lower and upper end above the array, in m")] public float radius = 0.03f, low = 0.13f, high = 0.17f;

        readonly double[] place = new double[3];

        void Update()
        {
            var hands = XRGeneralSettings.Instance?.Manager?.activeLoader?.GetLoadedSubsystem<XRHandSubsystem>();
            bool felt = false;
            if (hands != null && hands.rightHand.isTracked && hands.rightHand.GetJoint(XRHandJointID.Palm).TryGetPose(out var palm))
            {
                transform.position = origin.TransformPoint(palm.position);
                array.Put(transform.position, place, 0);
                felt = place[0] * place[0] + place[1] * place[1] < radius * radius && place[2] > low && place[2] < high;
            }
            player.enabled = felt;
        }
    }
}
