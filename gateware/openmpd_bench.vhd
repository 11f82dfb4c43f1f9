-- Two OpenMPD boards, each with its own bytes: the first leads, the second follows. Prints the pins at each change.
library ieee;
use ieee.std_logic_1164.all;
use ieee.numeric_std.all;
use std.textio.all;
use ieee.std_logic_textio.all;

entity bench is
    generic (bytes : string; offset : integer := 7);
end entity;

architecture simulated of bench is
    constant HALF : time := 12207031 fs;        -- half a period of 40.96 MHz
    signal clock : std_logic := '0';
    signal fast : std_logic_vector(0 to 1) := "00";
    signal sync : std_logic;
    signal byte : std_logic_vector(7 downto 0);
    signal ready : std_logic_vector(0 to 1) := "00";
    signal recorded : boolean := false;
    signal start : time;
    type boards is array (0 to 1) of std_logic_vector(255 downto 0);
    signal pins : boards;
begin
    clock <= not clock after 10 ns;
    fast(0) <= not fast(0) after HALF;
    process begin
        wait for offset * 1 ns;                 -- the second board has its own oscillator
        loop
            fast(1) <= not fast(1);
            wait for HALF;
        end loop;
    end process;

    first : entity work.board port map (clock, fast(0), ready(0), byte, '0', sync, pins(0));
    second : entity work.board port map (clock, fast(1), ready(1), byte, sync, open, pins(1));

    process
        type characters is file of character;
        file source : characters open read_mode is bytes;
        variable letter : character;
        variable number : integer := 0;
    begin
        wait for 60 us;
        while not endfile(source) loop
            read(source, letter);
            wait until falling_edge(clock);
            byte <= std_logic_vector(to_unsigned(character'pos(letter), 8));
            ready(number / 512) <= '1';
            wait until falling_edge(clock);
            ready <= "00";
            number := number + 1;
            wait for 100 ns;
        end loop;
        wait for 100 us;
        start <= now;
        recorded <= true;
        wait for 55 us;
        std.env.finish;
    end process;

    record_boards : for board in 0 to 1 generate
        process (pins(board), recorded)
            variable row : line;
        begin
            if recorded then
                write(row, board);
                write(row, ' ');
                write(row, (now - start) / 1 ps);
                write(row, ' ');
                hwrite(row, pins(board));
                writeline(output, row);
            end if;
        end process;
    end generate;
end architecture;
