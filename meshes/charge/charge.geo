// Eighth of a cube of rock around a spherical hole of radius 20 mm, with a core of 80 mm around that. Lengths in metres.
SetFactory("OpenCASCADE");

DefineConstant[
  h = 0.0035,        // element size at the hole
  inner = 0.0075,    // at the corners of the core
  far = 0.03         // and at those of the cube
];

a = 0.02; b = 0.08; L = 0.2;

Box(1) = {0, 0, 0, L, L, L};
Box(2) = {0, 0, 0, b, b, b};
Sphere(3) = {0, 0, 0, a};
BooleanDifference(4) = { Volume{2}; Delete; }{ Volume{3}; };
BooleanDifference(5) = { Volume{1}; Delete; }{ Volume{3}; Delete; };
parts() = BooleanFragments{ Volume{5}; Delete; }{ Volume{4}; Delete; };

e = 1e-6;
core() = Volume In BoundingBox {-e, -e, -e, b + e, b + e, b + e};
rock() = Volume{:};
rock() -= core();
hole() = Surface In BoundingBox {-e, -e, -e, a + e, a + e, a + e};
x0() = Surface In BoundingBox {-e, -e, -e, e, L + e, L + e};
y0() = Surface In BoundingBox {-e, -e, -e, L + e, e, L + e};
z0() = Surface In BoundingBox {-e, -e, -e, L + e, L + e, e};
x1() = Surface In BoundingBox {L - e, -e, -e, L + e, L + e, L + e};
y1() = Surface In BoundingBox {-e, L - e, -e, L + e, L + e, L + e};
z1() = Surface In BoundingBox {-e, -e, L - e, L + e, L + e, L + e};

Physical Volume("core") = {core()};
Physical Volume("rock") = {rock()};
Physical Surface("hole") = {hole()};
Physical Surface("x-") = {x0()};
Physical Surface("y-") = {y0()};
Physical Surface("z-") = {z0()};
Physical Surface("outside") = {x1(), y1(), z1()};

MeshSize{ PointsOf{ Volume{rock()}; } } = far;
MeshSize{ PointsOf{ Volume{core()}; } } = inner;
MeshSize{ PointsOf{ Surface{hole()}; } } = h;
Mesh.MeshSizeFromPoints = 1;
Mesh.Optimize = 1;
