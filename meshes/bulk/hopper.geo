// The facets of a hopper with an outlet of 60 mm, a cone of 45 degrees and a wall of 150 mm in height, in mm: gmsh hopper.geo -2
outlet = 30;                              // radii
radius = 80;
height = 150;
Point(1) = {outlet, 0, 0};
Point(2) = {radius, 0, radius - outlet};
Point(3) = {radius, 0, radius - outlet + height};
Line(1) = {1, 2};
Line(2) = {2, 3};
first[] = Extrude {{0, 0, 1}, {0, 0, 0}, 2*Pi/3} { Curve{1, 2}; };
second[] = Extrude {{0, 0, 1}, {0, 0, 0}, 2*Pi/3} { Curve{first[0], first[4]}; };
third[] = Extrude {{0, 0, 1}, {0, 0, 0}, 2*Pi/3} { Curve{second[0], second[4]}; };
Physical Surface("hopper") = {first[1], first[5], second[1], second[5], third[1], third[5]};
Mesh.MeshSizeMax = 25; Mesh.MeshSizeMin = 9;
