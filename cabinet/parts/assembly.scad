// The guide's pictures: a rod's bearing, mount and sensor, step by step.
//   stage = 1 bearing on the wall; 2 clamp; 3 rod, collars, index ring; 4 board and plate;
//   5 set the distance; 6 handle, finished; 7 exploded; 8 the same with a whole mouse on a broomstick
use <rod_bearing.scad>
use <sensor_mount.scad>
use <stop_collar.scad>
use <index_ring.scad>
use <handle.scad>
include <dimensions.scad>

stage = 7;

wall = 18;  // [mm]
apart = stage == 7 ? 1 : 0;

wood = [0.83, 0.68, 0.47];
steel = [0.72, 0.74, 0.77];
print = [0.25, 0.45, 0.70];
print_2 = [0.88, 0.52, 0.20];
board_green = [0.10, 0.45, 0.25];
black = [0.15, 0.15, 0.17];
rubber = [0.45, 0.20, 0.16];

// Flush but for what would flicker in the picture.
clamp_x = flange_thickness + barrel_length - clamp_width - 0.4;
plate_x = clamp_x + clamp_width + 3;
ring_x = -wall - 70;
rod_end = ring_x - 30 - 70;  // free for the hand; in the handle
board_top = rod_diameter / 2 + lens_distance + 3.4;

module wall() color(wood) difference() {
  translate([-wall, -62, -48]) cube([wall, 124, 96]);
  along_x(rod_diameter + 6, wall + 2, -wall - 1);
}
module sensor_board() translate([plate_x + 22, 0, board_top]) {
  color(board_green) translate([-14, -12, 0]) cube([28, 24, 1.6]);
  color(black) translate([-8, -5, 1.6]) cube([16, 10, 3]);
  color([0.9, 0.95, 1, 0.6]) translate([-8, -5, -3.4]) cube([16, 10, 3.4]);
  color([0.9, 0.9, 0.9]) translate([9, -8, 1.6]) cube([4, 16, 5]);
}
module rod(from, to) color(steel) along_x(rod_diameter, to - from, from);
module collar() {
  color(black) stop_collar();
  color(rubber) rubber_ring();
}
module collar_inside() translate([150, 0, 0]) mirror([1, 0, 0]) collar();

module screws() color([0.55, 0.57, 0.6]) for (side = [-1, 1], x = [-12, 12])
  translate([plate_x + 22 + x, side * (25.8 + 22 * apart), board_top + 6]) rotate([side * 90, 0, 0]) {
    translate([0, 0, -2]) cylinder(d = 5.5, h = 2);
    cylinder(d = 3, h = 9);
  }

if (stage < 8) {
  if (stage < 7) wall();
  color(print) translate([apart * -60, 0, 0]) rod_bearing();
  if (stage >= 2) color(print_2) translate([clamp_x, 0, 0]) sensor_clamp();
  if (stage >= 3) {
    rod(rod_end, 175);
    translate([ring_x + 10 - 35 * apart, 0, 0]) collar();
    translate([apart * 20, 0, 0]) collar_inside();
    color(print_2) translate([ring_x - 60 * apart, 0, 0]) index_ring();
  }
  if (stage >= 4) {
    lift = stage == 4 ? 34 : 45 * apart;
    translate([0, 0, lift]) color(print) translate([plate_x, 0, 0]) sensor_plate();
    translate([0, 0, stage == 4 ? 54 : 80 * apart]) sensor_board();
  }
  if (stage == 5) color([0.85, 0.2, 0.2]) translate([plate_x + 12, 0, 0]) lens_gauge();
  if (stage >= 5) screws();
  if (stage >= 6) color(black) translate([rod_end - 45 - apart * 60, 0, 0]) handle();
}

// A whole mouse on two rails beside a broomstick of 24 mm, which turns and slides in two V-blocks. The
// rails' tops are half a millimetre above the stick, so that it runs where the mouse's table would be.
stick = 24;
rail_top = stick / 2 + 0.5;
module v_block(x) color(wood) translate([x, 0, 0]) difference() {
  translate([0, -40, -45]) cube([25, 80, 45]);
  translate([-1, 0, 9]) rotate([45, 0, 0]) translate([0, -26 + 8, -26 + 8]) cube([27, 36, 36]);
}
if (stage == 8) {
  color(wood) translate([-190, -60, -57]) cube([380, 120, 12]);
  v_block(-150);
  v_block(125);
  color([0.78, 0.56, 0.36]) along_x(stick, 560, -280);
  color([0.93, 0.85, 0.70]) for (side = [0, 1]) mirror([0, side, 0])
    translate([-70, stick / 2 + 2, -45]) cube([140, 26, 45 + rail_top]);
  color(black) translate([0, 0, rail_top]) hull() {
    translate([-32, 0, 0]) cylinder(d = 58, h = 8);
    translate([34, 0, 0]) cylinder(d = 54, h = 8);
    translate([-22, 0, 20]) scale([1.3, 1, 0.5]) sphere(d = 42);
    translate([28, 0, 14]) scale([1.3, 1, 0.5]) sphere(d = 36);
  }
  color([0.3, 0.3, 0.3]) translate([58, 0, rail_top + 6]) rotate(along_rod) cylinder(d = 4, h = 50);
}
