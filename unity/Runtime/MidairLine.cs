// Line: sends a player's points to `midair serve` by OSC, or its frames to a serial port.
using System;
using System.IO;
using System.Linq;
using System.Net;
using System.Net.Sockets;
using System.Text;
using System.Threading;
using UnityEngine;

namespace Midair
{
    /// <summary>Sends points to `midair serve`, whose guard turns the board off 0.2 s after the last message, even if Unity
    /// crashes.</summary>
    sealed class ServerLine : IDisposable
    {
        readonly UdpClient server;
        readonly string token;

        /// <summary>Opens the address that `midair serve` prints: osc://127.0.0.1:PORT token TOKEN.</summary>
        internal ServerLine(string printed)
        {
            string[] words = printed.Trim().Split(' ');
            if (words.Length != 3 || !Uri.TryCreate(words[0], UriKind.Absolute, out var place) || place.Port < 1)
                throw new MidairException($"address is \"{printed}\": give the whole line of `midair serve`, osc://127.0.0.1:PORT token TOKEN");
            token = words[2];
            server = new UdpClient(place.Host, place.Port);
        }

        /// <summary>Sends rows of x, y, z in m and the pressure in Pa; no rows turn the board off.</summary>
        internal void Give(float[] rows) => Say(rows.Length == 0 ? "/midair/off" : "/midair/rows", rows);

        /// <summary>Sends an OSC message: the token and numbers.</summary>
        internal void Say(string name, params float[] numbers)
        {
            var message = new MemoryStream();
            Action<string> text = word => message.Write(Encoding.ASCII.GetBytes(word.PadRight(word.Length / 4 * 4 + 4, '\0')), 0, word.Length / 4 * 4 + 4);
            text(name);
            text(",s" + new string('f', numbers.Length));
            text(token);
            foreach (float number in numbers) message.Write(BitConverter.GetBytes(number).Reverse().ToArray(), 0, 4);
            try
            {
                server.Send(message.ToArray(), (int)message.Length);
                while (server.Available > 0)
                {
                    IPEndPoint from = null;
                    string[] words = Encoding.UTF8.GetString(server.Receive(ref from)).Split(new[] { '\0' }, StringSplitOptions.RemoveEmptyEntries);
                    if (words.Length == 3 && (words[0] == "/midair/warning" || words[0] == "/midair/error")) Debug.LogWarning($"midair serve: {words[2]}");
                }
            }
            catch (SocketException error)
            {
                throw new MidairException($"midair serve: {error.Message}: start it, and give the line that it prints now");
            }
        }

        public void Dispose() => server.Dispose();
    }

    /// <summary>A serial port that this program owns. A thread sends the newest frame, or silence if Unity gives none for 0.2
    /// s.</summary>
    sealed class SerialLine : IDisposable
    {
        const int Hold = 200;

        /// <summary>The reason why the thread ended, as one line; null while it runs.</summary>
        internal volatile string Failure;

        readonly AutoResetEvent given = new AutoResetEvent(false);
        readonly Thread thread;
        volatile byte[] newest;
        volatile bool ended;

        internal SerialLine(string name, Link link, byte[] off)
        {
            thread = new Thread(() =>
            {
                try
                {
                    using (Stream port = Open(name, link))
                    {
                        port.Write(off, 0, off.Length);
                        // The boot loader of an Arduino waits this long after its port is opened.
                        if (link.restarts != 0) Thread.Sleep(2000);
                        for (byte[] bytes = off; ; bytes = given.WaitOne(Hold) ? newest ?? off : off)
                        {
                            if (ended) bytes = off;
                            port.Write(bytes, 0, bytes.Length);
                            if (ended) break;
                            Thread.Sleep((int)Math.Ceiling(1000 / link.rate));
                        }
                    }
                }
                catch (Exception error)
                {
                    Failure = $"{name}: {error.Message}: the board may play on, switch its supply off";
                }
            }) { IsBackground = true };
            thread.Start();
        }

        static Stream Open(string name, Link link)
        {
#if NET_STANDARD || NET_STANDARD_2_0
            throw new MidairException("serial ports need the Api Compatibility Level .NET Framework: choose it in the Player settings");
#else
            var port = new System.IO.Ports.SerialPort(name, (int)link.baud) { WriteTimeout = 300, DtrEnable = link.restarts == 0 };
            port.Open();
            return port.BaseStream;
#endif
        }

        /// <summary>Sets the frame to be played, or null for silence.</summary>
        internal void Give(byte[] frame)
        {
            if (Failure != null) throw new MidairException(Failure);
            newest = frame;
            given.Set();
        }

        /// <summary>Silences the board and closes the port.</summary>
        public void Dispose()
        {
            bool failed = Failure != null;
            ended = true;
            given.Set();
            if (!thread.Join(3000)) Failure = "the serial port does not answer: the board may play on, switch its supply off";
            if (!failed && Failure != null) Debug.LogError(Failure);
        }
    }
}
