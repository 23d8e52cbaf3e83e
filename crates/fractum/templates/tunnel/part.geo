// Rock of 40 x 40 m with a tunnel of 2 m in radius and a blast hole of 200 mm, whose middle is 3 m from its wall, in m: gmsh part.geo -2
SetFactory("OpenCASCADE");
Rectangle(1) = {-20, -20, 0, 40, 40};
Disk(2) = {0, 0, 0, 2};
Disk(3) = {5, 0, 0, 0.1};
BooleanDifference(4) = { Surface{1}; Delete; }{ Surface{2, 3}; Delete; };
Physical Surface("rock") = {4};
Physical Curve("wall") = Curve In BoundingBox {-2.1, -2.1, -1, 2.1, 2.1, 1};
Physical Curve("hole") = Curve In BoundingBox {4.8, -0.2, -1, 5.2, 0.2, 1};
Physical Curve("far") = {Curve In BoundingBox {-20.1, -20.1, -1, -19.9, 20.1, 1}, Curve In BoundingBox {19.9, -20.1, -1, 20.1, 20.1, 1}, Curve In BoundingBox {-20.1, -20.1, -1, 20.1, -19.9, 1}, Curve In BoundingBox {-20.1, 19.9, -1, 20.1, 20.1, 1}};
Mesh.Algorithm = 5;                       // Delaunay: no rows that cracks could follow
Field[1] = MathEval;                      // around the tunnel
Field[1].F = "0.15 + 0.15*(Sqrt(x*x + y*y) - 2)";
Field[2] = MathEval;                      // around the hole
Field[2].F = "0.02 + 0.0225*Min(Sqrt((x - 5)^2 + y*y) - 0.1, 1.5) + 0.15*Max(Sqrt((x - 5)^2 + y*y) - 1.6, 0)";
Field[3] = Min;
Field[3].FieldsList = {1, 2};
Background Field = 3;
Mesh.MeshSizeMax = 1.5;
Mesh.MeshSizeExtendFromBoundary = 0; Mesh.MeshSizeFromPoints = 0;
