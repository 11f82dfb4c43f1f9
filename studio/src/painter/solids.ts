/** Obstacles: shaded spheres, and walls as translucent squares near the scene. */

import type { Obstacle, Vec3 } from "../state/types.ts";
import { along, cross, dot, type Piece, unit } from "./camera.ts";
import { type Gl, program } from "./gl.ts";
import { type Line, outline } from "./lines.ts";
import type { Bounds } from "./stage.ts";
import { aim, type View } from "./view.ts";

const BALL_VERTEX = `
uniform mat4 matrix;
uniform vec3 center;
uniform float radius;
out vec3 n, place;
void main() {
  // A sphere of 24 rings with 48 quads each, computed without a mesh.
  int quad = gl_VertexID / 6, corner = int[6](0, 1, 2, 2, 1, 3)[gl_VertexID % 6];
  float yaw = float(quad % 48 + (corner & 1)) / 48. * 6.2831853;
  float down = float(quad / 48 + (corner >> 1)) / 24. * 3.1415927;
  n = vec3(cos(yaw) * sin(down), sin(yaw) * sin(down), cos(down));
  place = center + radius * n;
  gl_Position = matrix * vec4(place, 1);
}`;

const BALL_FRAGMENT = `
uniform vec3 eye, body;
in vec3 n, place;
out vec4 colour;
void main() {
  vec3 m = normalize(n), light = normalize(vec3(-.35, -.5, .9)), to = normalize(eye - place);
  float lit = .32 + .5 * max(dot(m, light), 0.) + .18 * (m.z * .5 + .5);
  float gloss = pow(max(dot(reflect(-light, m), to), 0.), 40.), edge = pow(1. - max(dot(m, to), 0.), 3.);
  colour = vec4(body * lit + .28 * gloss + .14 * edge, 1);
}`;

const WALL_VERTEX = `
uniform mat4 matrix;
uniform vec3 corner, u, v;
void main() {
  gl_Position = matrix * vec4(corner + float(gl_VertexID & 1) * u + float(gl_VertexID >> 1) * v, 1);
}`;

const WALL_FRAGMENT = `
uniform vec4 ink;
out vec4 colour;
void main() { colour = vec4(ink.rgb * ink.a, ink.a); }`;

/** Returns the shown part of a wall: corner and sides (m) of a square, at the height of the middle of `bounds`. */
export function wallSquare(point: Vec3, normal: Vec3, bounds: Bounds): Piece {
  const n = unit(normal);
  const middle = [0, 1, 2].map((k) => (bounds.least[k] + bounds.most[k]) / 2) as Vec3;
  const foot = along(middle, dot(n, along(point, -1, middle)), n);
  const reach = 0.6 * Math.max(...[0, 1, 2].map((k) => bounds.most[k] - bounds.least[k]));
  const level = Math.hypot(n[0], n[1]);
  const across: Vec3 = level > 1e-6 ? [-n[1] / level, n[0] / level, 0] : [1, 0, 0];
  const up = cross(n, across);
  const corner = along(along(foot, -reach, across), -reach, up);
  return { corner, u: along([0, 0, 0], 2 * reach, across), v: along([0, 0, 0], 2 * reach, up) };
}

/** Returns the edges of the walls, in a warm colour for soft walls. */
export function wallLines(obstacles: Obstacle[], bounds: Bounds): Line[] {
  return obstacles.flatMap((wall) => {
    if ("radius" in wall) return [];
    return outline(wallSquare(wall.point, wall.normal, bounds), [...tint(wall), 0.7], 1.2);
  });
}

const tint = (obstacle: Obstacle): Vec3 => ("tint" in obstacle && obstacle.tint) || (obstacle.kind === "rigid" ? [0.56, 0.62, 0.7] : [0.78, 0.6, 0.5]);

/** Makes the functions that paint obstacles. Spheres are opaque and walls are translucent, so paint spheres first. */
export function createSolids(gl: Gl) {
  const balls = program(gl, BALL_VERTEX, BALL_FRAGMENT);
  const walls = program(gl, WALL_VERTEX, WALL_FRAGMENT);
  return {
    balls(view: View, obstacles: Obstacle[]): void {
      aim(balls, view);
      for (const ball of obstacles) {
        if (!("radius" in ball)) continue;
        balls.set("center", ball.center);
        balls.set("radius", ball.radius);
        balls.set("body", tint(ball));
        gl.drawArrays(gl.TRIANGLES, 0, 24 * 48 * 6);
      }
    },
    walls(view: View, obstacles: Obstacle[], bounds: Bounds): void {
      aim(walls, view);
      gl.depthMask(false);
      for (const wall of obstacles) {
        if ("radius" in wall) continue;
        const { corner, u, v } = wallSquare(wall.point, wall.normal, bounds);
        walls.set("corner", corner);
        walls.set("u", u);
        walls.set("v", v);
        walls.set("ink", [...tint(wall), 0.16]);
        gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
      }
      gl.depthMask(true);
    },
  };
}
