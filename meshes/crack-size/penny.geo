// Quarter of a cylinder with a disc-shaped crack across its middle, pulled along z; lengths in metres.
SetFactory("Built-in");
DefineConstant[
  h = 0.4            // element size, over the process zone of 1/3 m
  a = 1              // radius of the crack, over the process zone
  width = 3          // radius of the cylinder
  height = 3         // half of its length
];
zone = 1/3;
A = a*zone; W = width*zone; H = height*zone; s = h*zone;
Point(12) = {0,0,0,s}; Point(1) = {0,0,A/500,s}; Point(2) = {A,0,0,s}; Point(3) = {0,A,0,s}; Point(4) = {W,0,0,s}; Point(5) = {0,W,0,s};
Circle(1) = {2,12,3}; Circle(2) = {4,12,5};
Line(3) = {2,4}; Line(4) = {3,5};
// The crack opens by 1/250 of its radius, since its sides may not be the same place.
Point(11) = {0,0,-A/500,s};
Line(5) = {1,2}; Line(6) = {1,3}; 
Line(15) = {11,2}; Line(16) = {11,3};
Point(6) = {0,0,H,s}; Point(7) = {W,0,H,s}; Point(8) = {0,W,H,s};
Point(16) = {0,0,-H,s}; Point(17) = {W,0,-H,s}; Point(18) = {0,W,-H,s};
Line(21) = {1,6}; Line(22) = {6,7}; Line(23) = {6,8}; Circle(24) = {7,6,8}; Line(25) = {4,7}; Line(26) = {5,8};
Line(31) = {11,16}; Line(32) = {16,17}; Line(33) = {16,18}; Circle(34) = {17,16,18}; Line(35) = {4,17}; Line(36) = {5,18};
Curve Loop(1) = {5,1,-6}; Surface(1) = {1};
Curve Loop(2) = {15,1,-16}; Surface(2) = {2};
Curve Loop(3) = {3,2,-4,-1}; Plane Surface(3) = {3};
Curve Loop(4) = {21,22,-25,-3,-5}; Plane Surface(4) = {4};
Curve Loop(5) = {21,23,-26,-4,-6}; Plane Surface(5) = {5};
Curve Loop(6) = {22,24,-23}; Plane Surface(6) = {6};
Curve Loop(7) = {25,24,-26,-2}; Surface(7) = {7};
Curve Loop(14) = {31,32,-35,-3,-15}; Plane Surface(14) = {14};
Curve Loop(15) = {31,33,-36,-4,-16}; Plane Surface(15) = {15};
Curve Loop(16) = {32,34,-33}; Plane Surface(16) = {16};
Curve Loop(17) = {35,34,-36,-2}; Surface(17) = {17};
Surface Loop(1) = {1,3,4,5,6,7}; Volume(1) = {1};
Surface Loop(2) = {2,3,14,15,16,17}; Volume(2) = {2};
Physical Volume("body") = {1,2};
Physical Surface("top") = {6}; Physical Surface("bottom") = {16};
Physical Surface("y0") = {4,14}; Physical Surface("x0") = {5,15};
Mesh.Optimize = 1;
