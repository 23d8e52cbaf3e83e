// Eighth of a cube of rock of 400 mm with a ball of radius 20 mm in it, `core`, that is taken out. Lengths in metres.
SetFactory("OpenCASCADE");

DefineConstant[
  h = 0.0028,        // element size at the ball
  far = 0.05         // and at the corners of the cube
];

a = 0.02; L = 0.2;

Box(1) = {0, 0, 0, L, L, L};
Sphere(2) = {0, 0, 0, a, 0, Pi / 2, Pi / 2};
parts() = BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; };

e = 1e-6;
core() = Volume In BoundingBox {-e, -e, -e, a + e, a + e, a + e};
rock() = Volume{:};
rock() -= core();
x0() = Surface In BoundingBox {-e, -e, -e, e, L + e, L + e};
y0() = Surface In BoundingBox {-e, -e, -e, L + e, e, L + e};
z0() = Surface In BoundingBox {-e, -e, -e, L + e, L + e, e};
x1() = Surface In BoundingBox {L - e, -e, -e, L + e, L + e, L + e};
y1() = Surface In BoundingBox {-e, L - e, -e, L + e, L + e, L + e};
z1() = Surface In BoundingBox {-e, -e, L - e, L + e, L + e, L + e};
all() = Abs(Boundary{ Volume{core()}; });
wall() = all();
wall() -= x0();
wall() -= y0();
wall() -= z0();

Physical Volume("rock") = {rock()};
Physical Volume("core") = {core()};
Physical Surface("x-") = {x0()};
Physical Surface("y-") = {y0()};
Physical Surface("z-") = {z0()};
Physical Surface("outside") = {x1(), y1(), z1()};
Physical Surface("wall") = {wall()};

MeshSize{ PointsOf{ Volume{rock()}; } } = far;
MeshSize{ PointsOf{ Volume{core()}; } } = h;
Mesh.MeshSizeFromPoints = 1;
Mesh.Optimize = 1;
