// Holds a sensor board over the rod, on the bearing's barrel: a clamp with two arms, a plate between
// them that slides up and down, and a gauge that sets the lens's distance.
//   part  = "clamp", "plate" or "gauge"
//   board = "pmw3360" (a breakout board) or "ps2" (the board cut from a mouse, with its lens)
include <dimensions.scad>

part = "clamp";
board = "pmw3360";

// Measure the board that you have: breakouts differ. [length along the rod, width] of the board,
// [pitch along, across] of its holes, hole for a self-cutting screw of 2 mm, [length, width] of the
// lens's window, how far the lens's lower face stands below the board's lower face. [mm]
function board_size(b) = b == "pmw3360" ? [28, 24] : [34, 30];
function board_pitch(b) = b == "pmw3360" ? [23, 19] : [28, 24];
function board_window(b) = b == "pmw3360" ? [19, 14] : [22, 18];
function lens_below(b) = b == "pmw3360" ? 3.4 : 4.0;
pilot_hole = 1.7;

plate_thickness = 4;       // [mm]
plate_length = 44;         // along the rod [mm]
plate_width = 41;          // across it; the widest board, its clearance and the two ears [mm]
ear_height = 12;           // of the plate's two sides [mm]
ear_thickness = 5;         // holds the nut [mm]
screw_pitch = 24;          // of a side's two screws, along the rod [mm]
arm_start = 3;             // ring to plate, along the rod: clearance for the flare of the barrel [mm]

// Heights above the rod's axis [mm].
board_height = rod_diameter / 2 + lens_distance + lens_below(board);  // the plate's upper face
plate_bottom = board_height - plate_thickness;
screw_height = board_height + ear_height / 2;

ring_diameter = barrel_diameter + 2 * clamp_wall;
arm_inside = plate_width / 2 + arm_gap;
arm_length = clamp_width + arm_start + plate_length;
arm_height = ear_height + 2 * height_range;

// Ring from x = 0 to clamp_width; the rod along x.
module sensor_clamp() {
  difference() {
    union() {
      along_x(ring_diameter, clamp_width);
      translate([0, -7, -ring_diameter / 2 - 7]) cube([clamp_width, 14, 12]);
      for (side = [-1, 1]) mirror([0, side < 0 ? 1 : 0, 0]) arm();
    }
    along_x(barrel_diameter + 0.2, clamp_width + 2, -1);
    translate([-1, -clamp_slit / 2, -ring_diameter]) cube([clamp_width + 2, clamp_slit, ring_diameter]);
    translate([clamp_width / 2, 0, -ring_diameter / 2 - 3]) rotate([90, 0, 0]) {
      cylinder(d = screw, h = 40, center = true);
      translate([0, 0, 7 - nut_depth]) cylinder(d = nut_width / cos(30), h = 20, $fn = 6);
    }
  }
}

module arm() {
  difference() {
    hull() {
      translate([0, arm_inside, screw_height - arm_height / 2]) cube([arm_length, arm_thickness, arm_height]);
      translate([0, arm_inside, -6]) cube([clamp_width, arm_thickness, 12]);
    }
    for (x = [-1, 1])
      translate([clamp_width + arm_start + plate_length / 2 + x * screw_pitch / 2, 0, screw_height])
        hull() for (z = [-1, 1]) translate([0, 0, z * height_range])
          rotate([-90, 0, 0]) cylinder(d = screw, h = 100);
  }
  // Joins ring and arm.
  translate([0, ring_diameter / 2 - 3, -6]) cube([clamp_width, arm_inside - ring_diameter / 2 + 4, 12]);
}

// Where the clamp has it: the rod's axis is z = 0, the lens's centre over x = plate_length / 2.
module sensor_plate() {
  difference() {
    union() {
      translate([0, -plate_width / 2, plate_bottom]) cube([plate_length, plate_width, plate_thickness]);
      for (side = [-1, 1])
        translate([0, side < 0 ? -plate_width / 2 : plate_width / 2 - ear_thickness, plate_bottom])
          cube([plate_length, ear_thickness, plate_thickness + ear_height]);
    }
    translate([plate_length / 2, 0, 0]) {
      window = board_window(board);
      translate([-window[0] / 2, -window[1] / 2, 0]) cube([window[0], window[1], 40]);
      // The rod passes below, and the gauge on it, which has to touch the lens and not the plate.
      along_x(rod_diameter + 2 * lens_distance + 1, plate_length + 2, -plate_length / 2 - 1);
      for (x = [-1, 1], y = [-1, 1])
        translate([x * board_pitch(board)[0] / 2, y * board_pitch(board)[1] / 2, 0]) cylinder(d = pilot_hole, h = 60);
      for (x = [-1, 1], side = [-1, 1])
        translate([x * screw_pitch / 2, side * plate_width / 2, screw_height]) rotate([side * 90, 0, 0]) {
          translate([0, 0, -1]) cylinder(d = screw, h = 20);
          translate([0, 0, ear_thickness - nut_depth]) cylinder(d = nut_width / cos(30), h = nut_depth + 0.01, $fn = 6);
        }
    }
  }
}

// Laid on the rod under the lens while the screws are tightened, then pulled out.
module lens_gauge() {
  width = 10;
  difference() {
    union() {
      intersection() {
        along_x(rod_diameter + 2 * lens_distance, 60);
        translate([-1, -width / 2, 0]) cube([62, width, 40]);
      }
      translate([48, -width / 2, 0]) cube([12, width, rod_diameter / 2 + lens_distance]);
    }
    along_x(rod_diameter, 62, -1);
  }
}

// As printed.
if (part == "clamp") rotate([0, -90, 0]) sensor_clamp();
if (part == "plate") translate([0, 0, -plate_bottom]) sensor_plate();
if (part == "gauge") translate([0, 0, 5]) rotate([90, 0, 0]) lens_gauge();
