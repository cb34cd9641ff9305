// A narrow clamp ring with a pointer, for "feet straight down". It is outside the wall, where a switch would
// be in the hands' way: the index mark that the program reads is the magnet of the inner stop collar.
include <dimensions.scad>

ring_width = 10;     // along the rod [mm]
ring_diameter = 36;  // [mm]
pointer = 5;         // beyond the ring [mm]

module index_ring() {
  difference() {
    union() {
      along_x(ring_diameter, ring_width);
      rotate([90, 0, 90]) linear_extrude(ring_width)
        polygon([[-4, ring_diameter / 2 - 1], [4, ring_diameter / 2 - 1], [0, ring_diameter / 2 + pointer]]);
    }
    along_x(rod_diameter + 0.15, ring_width + 2, -1);
    translate([-1, -clamp_slit / 2, -ring_diameter]) cube([ring_width + 2, clamp_slit, ring_diameter]);
    translate([ring_width / 2, 0, -rod_diameter / 2 - 4.5]) rotate([90, 0, 0]) {
      cylinder(d = screw, h = 60, center = true);
      translate([0, 0, 6]) cylinder(d = nut_width / cos(30), h = 20, $fn = 6);
      translate([0, 0, -26]) cylinder(d = 6.2, h = 20);
    }
  }
}

rotate([0, 90, 0]) translate([-ring_width, 0, 0]) index_ring();
