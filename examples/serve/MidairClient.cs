// A focus at each child of this object, in Unity: x, y, z of Unity are x, z, y of midair.
using System;
using System.Net.WebSockets;
using System.Threading;
using UnityEngine;

public class MidairClient : MonoBehaviour
{
    public string address = "ws://127.0.0.1:PORT/?token=...";
    readonly ClientWebSocket server = new ClientWebSocket();
    bool sending;

    async void Start() => await server.ConnectAsync(new Uri(address), CancellationToken.None);

    async void Update()
    {
        if (server.State != WebSocketState.Open || sending || transform.childCount == 0) return;
        var rows = new float[4 * transform.childCount];
        for (var k = 0; k < transform.childCount; k++)
        {
            var at = transform.GetChild(k).localPosition;
            (rows[4 * k], rows[4 * k + 1], rows[4 * k + 2]) = (at.x, at.z, at.y);
        }
        var message = new byte[4 * rows.Length];
        Buffer.BlockCopy(rows, 0, message, 0, message.Length);
        sending = true;
        await server.SendAsync(message, WebSocketMessageType.Binary, true, CancellationToken.None);
        sending = false;
    }

    void OnDestroy() => server.Dispose();
}
