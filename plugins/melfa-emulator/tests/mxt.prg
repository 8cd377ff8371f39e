1 Servo On
2 Open "ENET:127.0.0.1" As #1
3 Mxt 1,0,10
4 Hlt
5 End
