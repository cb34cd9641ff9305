// What two things have in common where they are put together: nothing, or they do not fit.
// scripts/render_parts.py renders each pair, and wants no solid.
//   pair = "gauge plate", "board plate", "rod plate", "clamp plate", "bearing clamp" or "rod clamp"
use <rod_bearing.scad>
include <sensor_mount.scad>

part = "none";
pair = "gauge plate";

module board_on_plate() translate([plate_length / 2 - board_size(board)[0] / 2, -board_size(board)[1] / 2, board_height + 0.01])
  cube([board_size(board)[0], board_size(board)[1], 1.6]);

if (pair == "gauge plate") intersection() { lens_gauge(); sensor_plate(); }
if (pair == "board plate") intersection() { minkowski() { board_on_plate(); cube([0.4, 0.4, 0.001], center = true); } sensor_plate(); }
if (pair == "rod plate") intersection() { along_x(rod_diameter, 200, -100); sensor_plate(); }
if (pair == "rod clamp") intersection() { along_x(rod_diameter, 200, -100); sensor_clamp(); }
if (pair == "clamp plate") intersection() { translate([-clamp_width - arm_start, 0, 0]) sensor_clamp(); sensor_plate(); }
if (pair == "bearing clamp") intersection() {
  translate([clamp_width - flange_thickness - barrel_length, 0, 0]) rod_bearing();
  sensor_clamp();
}
