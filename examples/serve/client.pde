// A focus that follows the mouse, by OSC: Processing with the library oscP5.
// Put the port and the token that midair serve prints here.
import netP5.*;
import oscP5.*;

final int PORT = 49120;
final String TOKEN = "...";

OscP5 osc;
NetAddress midair;

void setup() {
  size(400, 400);
  osc = new OscP5(this, 0);
  midair = new NetAddress("127.0.0.1", PORT);
  frameRate(60);
}

void draw() {
  background(0);
  circle(mouseX, mouseY, 20);
  OscMessage message = new OscMessage("/midair/points");
  message.add(TOKEN);
  // 400 pixels are 80 mm, 15 cm above the array.
  message.add((mouseX - 200) / 5000.0);
  message.add((200 - mouseY) / 5000.0);
  message.add(0.15);
  osc.send(message, midair);
}
