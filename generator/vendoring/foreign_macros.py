"""Names that headers of other libraries have as macros."""

from __future__ import annotations

_XLIB = """Status Bool True False None Success Always Above Below Complex Convex Opposite
TopIf BottomIf NotUseful WhenMapped Unsorted YSorted XYBanded GrayScale
StaticColor Expose KeyPress Nonconvex DestroyAll"""
_WINDOWS = """min max near far small hyper interface ERROR IN OUT OPTIONAL TRUE FALSE pascal
cdecl CONST VOID rad1 rad2 rad3 psh1 psh2 chx1 edt1 grp1 frm1 lst1 cmb1 scr1
stc1 ctl1 DELETE STRICT CALLBACK DIFFERENCE ABSOLUTE RELATIVE NO_ERROR PASCAL
FAR NEAR THIS DOMAIN GetObject CreateWindow SendMessage"""
_ARDUINO = """abs min max round radians degrees sq bit lowByte highByte constrain F PI HALF_PI
TWO_PI EULER DEFAULT INPUT OUTPUT HIGH LOW CHANGE RISING FALLING SERIAL DISPLAY
EXTERNAL INTERNAL interrupts noInterrupts bitRead bitWrite bitSet bitClear A0 A1
A2 A3 A4 A5 B0 B1 B2 B3 word boolean"""
_CURSES = """move erase clear refresh timeout echo box border filter meta addch addstr
attrset insch delch getch getstr inch standout standend scroll touchwin OK ERR
stdscr hline vline"""
_MATH = """I M_PI M_E HUGE OVERFLOW UNDERFLOW DOMAIN SING PLOSS TLOSS isnan isinf isfinite
signbit fpclassify isnormal isless isgreater complex imaginary HUGE_VAL INFINITY
NAN log2"""
_SYSTEM = """ECHO B50 B75 B110 B300 NL0 CR0 TAB0 BS0 VT0 FF0 major minor makedev unix linux
howmany roundup powerof2 MIN MAX check verify require assert swap select likely
unlikely"""

FOREIGN_MACROS = tuple(
    sorted(set(" ".join((_XLIB, _WINDOWS, _ARDUINO, _CURSES, _MATH, _SYSTEM)).split()))
)
